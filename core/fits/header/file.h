/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/file.h: an open FITS file and its HDUs: their places, sizes and types.
 *
 * All headers are read when a file is opened, and an HDU that does not fit into the file is
 * refused. Keywords that decide where an HDU ends must be present, in range, and unique. CFITSIO is
 * never given the file itself: for an HDU that is read it is given a view with a header made for it
 * (view.h). */
#pragma once

#include "fits/io/source.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SF_AXES = 3, SF_NAME = 72, SF_BLOCK_BYTES = 2880 };

enum sf_kind { SF_IMAGE = 0, SF_TABLE, SF_OTHER };

typedef struct sf_hdu {
    int number;                           /* 0 = primary */
    enum sf_kind kind;                    /* a compressed image is a table with zimage */
    char name[SF_NAME];                   /* EXTNAME */
    int64_t bitpix, naxis, axes[SF_AXES]; /* axes beyond naxis are 1 */
    int64_t pcount, gcount;
    int64_t header_offset, header_bytes;
    uint64_t header_hash;            /* of its blocks: sf_header_hash() */
    int64_t data_offset, data_bytes; /* bytes without padding */
    bool zimage, ztable;             /* tile-compressed image; tile-compressed table */
} sf_hdu;

typedef struct sf_file {
    sf_source source;
    sf_hdu *hdus; /* [capacity], count in use */
    int count;
    size_t capacity;
} sf_file;

/* Open a file, or a duplicate of `fd` (see sf_source_open), and read its headers. SHEAR_E_FORMAT,
 * SHEAR_E_IO, SHEAR_E_NOMEM. Call sf_file_close after an error, too. */
int sf_file_open(sf_file *f, const char *path, int fd, shear_error *err);
void sf_file_close(sf_file *f);

/* Return a number of bytes, rounded up to whole blocks. */
int64_t sf_padded(int64_t bytes);

/* Find the extension called `name`, ignoring case. *hdu is NULL if it is absent and not required.
 * SHEAR_E_FORMAT: it is required but absent (the message lists the extensions), or there are two.
 */
int sf_file_find(const sf_file *f, const char *name, bool required, const sf_hdu **hdu,
                 shear_error *err);
