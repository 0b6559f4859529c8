/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/schema/result_columns.h: the columns and flag keywords of result catalogs, for their writer
 * and reader. */
#pragma once

#include "shear/field.h"

#include <stddef.h>

#define SF_CATALOG_HDU "SHEAR"

/* Columns that are copied from the field file, if it has them: bits of enum shear_column. They are
 * the first of the catalog, ID before the others. */
enum {
    SF_CATALOG_COPIED = SHEAR_COL_ID | SHEAR_COL_X | SHEAR_COL_Y | SHEAR_COL_RA | SHEAR_COL_DEC |
                        SHEAR_COL_GF1 | SHEAR_COL_GF2
};

/* The columns that hold a member of the row: a double (form "D"), or an integer of 32 bits ("J").
 */
enum { SF_CATALOG_MEMBERS = 20 };
typedef struct sf_member {
    const char *name;
    const char *form;
    size_t offset; /* in shear_row */
    int64_t shift; /* of "J": the file has the integer plus this, */
    int64_t most;  /* from `shift` up to this; anything else is read as 0 in the file */
    const char *unit;
    const char *comment;
} sf_member;
/* The unit of what has a square of k more than N1 and D; where the shear is on the sky, of arcsec.
 */
#define SF_PER_AREA        "pixel**-2"
#define SF_PER_AREA_OF_SKY "arcsec**-2"
extern const sf_member sf_catalog_members[SF_CATALOG_MEMBERS];

/* NF_...: the number of rows that carry flag i. */
extern const char *const sf_flag_keywords[SHEAR_N_FLAGS];
