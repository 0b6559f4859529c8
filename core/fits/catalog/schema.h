/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/catalog/schema.h: the columns and flag keywords of result catalogs, for their writer and
 * reader. */
#pragma once

#include "shear/stamp.h"

#include <stddef.h>

#define SF_CATALOG_HDU "SHEAR"

/* Columns that are copied from the field file, if it has them: bits of enum shear_column. */
enum { SF_CATALOG_COPIED = 5 };
extern const unsigned sf_catalog_copied[SF_CATALOG_COPIED];

/* The columns that hold a double of the row. */
enum { SF_CATALOG_MEMBERS = 17 };
typedef struct sf_member {
    const char *name;
    size_t offset; /* of the double in shear_row */
    const char *unit;
    const char *comment;
} sf_member;
extern const sf_member sf_catalog_members[SF_CATALOG_MEMBERS];

/* Columns of pixel coordinates, after FLAGS: they count from 1, 0 = none; the member counts from 0,
 * -1 = none. */
enum { SF_CATALOG_PLACES = 2 };
typedef struct sf_place_member {
    const char *name;
    size_t offset; /* of the int in shear_row */
    const char *comment;
} sf_place_member;
extern const sf_place_member sf_catalog_places[SF_CATALOG_PLACES];

/* NF_...: the number of rows that carry flag i. */
extern const char *const sf_flag_keywords[SHEAR_N_FLAGS];
