/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/schema/field_columns.h"

#include <stddef.h>
#include <string.h>

/* The members of shear_catalog_columns and of shear_block that hold a column. */
#define ARRAYS(in_rows, in_block)                                                                  \
    offsetof(shear_catalog_columns, in_rows), offsetof(shear_block, in_block)

const sf_column_def sf_column_defs[SF_COLUMNS] = {
    {"ID", SHEAR_COL_ID, "K", 1, "", "the galaxy's number", ARRAYS(id, id), -1},
    {"X", SHEAR_COL_X, "D", 1, "pixel", "position in the exposure", ARRAYS(x, x), 0},
    {"Y", SHEAR_COL_Y, "D", 1, "pixel", "position in the exposure", ARRAYS(y, y), 0},
    {"RA", SHEAR_COL_RA, "D", 1, "deg", "right ascension", ARRAYS(ra, ra), 0},
    {"DEC", SHEAR_COL_DEC, "D", 1, "deg", "declination", ARRAYS(dec, dec), 0},
    {"WEIGHT", SHEAR_COL_WEIGHT, "D", 1, "", "weight in the field's sums", ARRAYS(weight, weight),
     0},
    {"PSF_ID", SHEAR_COL_PSF_ID, "J", 1, "", "which image of HDU PSF, from 0",
     offsetof(shear_catalog_columns, psf_id), 0, -1},
    {"R_GAL", SHEAR_COL_R_GAL, "D", 1, "pixel", "scale radius R_G for the filter",
     ARRAYS(r_gal, r_gal), 0},
    {"FLAGS", SHEAR_COL_FLAGS, "J", 1, "", "non-zero = leave the stamp out", ARRAYS(flags, mask),
     1}, /* a stamp whose flag is undefined is left out */
    {"JACOBIAN", SHEAR_COL_JACOBIAN, "4D", 4, "arcsec/pixel", "du/dx, du/dy, dv/dx, dv/dy; u West",
     ARRAYS(jacobian, jacobian), 0},
    {"PSF_TERMS", SHEAR_COL_PSF_TERMS, "D", 0, "", "coefficients of its PSF model",
     ARRAYS(psf_terms, psf_terms), 0},
    {"DROPPED", SHEAR_COL_DROPPED, "J", 1, "",
     "why the stamp cannot be used: bits of FLAGS in results", ARRAYS(dropped, dropped),
     SHEAR_FLAG_MASKED},
    {"GF1", SHEAR_COL_GF1, "D", 1, "", "shear by the optics' distortion, pixel frame",
     ARRAYS(gf1, gf1), 0},
    {"GF2", SHEAR_COL_GF2, "D", 1, "", "shear by the optics' distortion, pixel frame",
     ARRAYS(gf2, gf2), 0},
};

void *sf_column_array(const void *arrays, size_t offset) {
    void *array = NULL; /* copied: a pointer to another type must not be read as a void pointer */
    memcpy(&array, (const char *)arrays + offset, sizeof array);
    return array;
}
