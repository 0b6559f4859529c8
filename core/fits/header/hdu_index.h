/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/hdu_index.h: index the HDUs of a file: their places, sizes and types.
 *
 * All headers of a file are read here, in fixed memory, and an HDU that does not fit into the file
 * is refused. Keywords that decide where an HDU ends must be present, in range, and unique. CFITSIO
 * is never given the file itself: for an HDU that is read it is given a view with a header made for
 * it (view.h). */
#pragma once

#include "fits/io/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SF_AXES = 3, SF_NAME = 72, SF_BLOCK_BYTES = 2880 };

/* Value of an integer keyword that is absent. */
#define SF_ABSENT INT64_MIN

enum sf_kind { SF_IMAGE = 0, SF_TABLE, SF_OTHER };

typedef struct sf_hdu {
    int number;                           /* 0 = primary */
    enum sf_kind kind;                    /* a compressed image is a table with zimage */
    char name[SF_NAME];                   /* EXTNAME */
    int64_t bitpix, naxis, axes[SF_AXES]; /* axes beyond naxis are 1 */
    int64_t pcount, gcount;
    int64_t header_offset, header_bytes;
    uint64_t header_hash;            /* XXH3 of the header's bytes */
    int64_t data_offset, data_bytes; /* bytes without padding */
    bool zimage, ztable;             /* tile-compressed image; tile-compressed table */
} sf_hdu;

typedef struct sf_hdu_index {
    sf_hdu *hdus; /* [capacity], count in use */
    int count;
    size_t capacity;
    const char *file; /* for messages; owned by the source */
} sf_hdu_index;

/* Index the FITS file `fd` of `size` bytes. SHEAR_E_FORMAT, SHEAR_E_IO, SHEAR_E_NOMEM. */
/* Call sf_hdu_index_deinit after an error, too. */
int sf_hdu_index_init(sf_hdu_index *s, int fd, int64_t size, const char *file, shear_error *err);
void sf_hdu_index_deinit(sf_hdu_index *s);

/* Find the extension called `name`, ignoring case. *hdu is NULL if it is absent and not required.
 * SHEAR_E_FORMAT: it is required but absent (the message lists the extensions), or there are two.
 */
int sf_hdu_index_find(const sf_hdu_index *s, const char *name, bool required, const sf_hdu **hdu,
                      shear_error *err);
