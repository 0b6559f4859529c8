/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/hdu_index.h: where the HDUs of a file are and how large.
 *
 * All headers of a file are read here, in fixed memory, and what does not fit into the file is
 * refused. Keywords that say where an HDU ends must be there, in range, and only once.
 * CFITSIO does not see the file at all: of the HDUs that are read it sees what is made for it
 * (view.h), and never the others.
 */
#ifndef SHEAR_FITS_HEADER_HDU_INDEX_H
#define SHEAR_FITS_HEADER_HDU_INDEX_H

#include "fits/io/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SF_AXES = 3, SF_NAME = 72, SF_BLOCK_BYTES = 2880 };

/* Value of an integer keyword that the header does not have. */
#define SF_ABSENT INT64_MIN

enum sf_kind { SF_IMAGE = 0, SF_TABLE, SF_OTHER };

typedef struct sf_hdu {
    int number;                           /* 0 = primary */
    enum sf_kind kind;                    /* a compressed image is a table with zimage */
    char name[SF_NAME];                   /* EXTNAME */
    int64_t bitpix, naxis, axes[SF_AXES]; /* axes beyond naxis are 1 */
    int64_t pcount, gcount;
    int64_t header_offset, header_bytes;
    uint64_t header_hash;            /* of these bytes */
    int64_t data_offset, data_bytes; /* without padding */
    bool zimage, ztable;             /* tile-compressed image, table */
} sf_hdu;

typedef struct sf_hdu_index {
    sf_hdu *hdus; /* [capacity], count in use */
    int count;
    size_t capacity;
    const char *file; /* for messages; the source's */
} sf_hdu_index;

/* Index the FITS file `fd` of `size` bytes. SHEAR_E_FORMAT, SHEAR_E_IO, SHEAR_E_NOMEM. */
/* Deinit it, also after an error. */
int sf_hdu_index_init(sf_hdu_index *s, int fd, int64_t size, const char *file, shear_error *err);
void sf_hdu_index_deinit(sf_hdu_index *s);

/* The extension of that name, in any case. *hdu is NULL if it is absent and it is optional.
 * SHEAR_E_FORMAT: none although required (the message lists what there is), or two of them. */
int sf_hdu_index_find(const sf_hdu_index *s, const char *name, bool required, const sf_hdu **hdu,
                      shear_error *err);

#endif
