/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/survey.h: where the HDUs of a file are and how large, before CFITSIO sees the file.
 *
 * CFITSIO believes a header's sizes and allocates for them. The survey reads the headers itself, in
 * fixed memory, and refuses what does not fit into the file. Structural keywords must be there, in
 * range, and only once, so that CFITSIO cannot find another value than the one that was checked.
 */
#ifndef SHEAR_FITS_SURVEY_H
#define SHEAR_FITS_SURVEY_H

#include "fits/status.h"

#include <stdbool.h>
#include <stdint.h>

enum { SF_AXES = 3, SF_NAME = 72, SF_BLOCK_BYTES = 2880 };

/* Value of an integer keyword that the header does not have. */
#define SF_ABSENT INT64_MIN

enum sf_kind { SF_IMAGE = 0, SF_TABLE, SF_OTHER };

typedef struct sf_hdu {
    int number;         /* as CFITSIO counts: 1 = primary */
    int kind;           /* enum sf_kind; a compressed image is a table with zimage */
    char name[SF_NAME]; /* EXTNAME */
    int64_t bitpix, naxis, axes[SF_AXES]; /* axes beyond naxis are 1 */
    int64_t pcount, gcount, tfields, theap;
    int64_t data_offset, data_bytes; /* without padding */
    bool zimage, ztable;             /* tile-compressed image, table */
    int64_t zbitpix, znaxis, zaxes[SF_AXES], ztile[SF_AXES], zval[2];
    char zcmptype[SF_NAME], zquantiz[SF_NAME];
} sf_hdu;

typedef struct sf_survey {
    sf_hdu *hdus; /* [count] */
    int count;
    const char *file; /* for messages; the source's */
} sf_survey;

/* Survey the FITS file `fd` of `size` bytes. SHEAR_E_FORMAT, SHEAR_E_IO, SHEAR_E_NOMEM. */
int sf_survey_new(sf_survey *s, int fd, int64_t size, const char *file, shear_error *err);
void sf_survey_free(sf_survey *s);

/* The extension of that name, in any case. *hdu is NULL where there is none and it is optional.
 * SHEAR_E_FORMAT: none although required (the message lists what there is), or two of them. */
int sf_survey_find(const sf_survey *s, const char *name, bool required, const sf_hdu **hdu,
                   shear_error *err);

#endif
