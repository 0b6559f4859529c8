/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/schema/layout.h: the columns of a table that is being created. */
#pragma once

#include "shear/field.h"

/* The columns of a table that is being created, as CFITSIO wants them. */
enum { SF_LAYOUT_MAX = 32 + SHEAR_MAX_CARRIED };
typedef struct sf_layout {
    int n;
    char *names[SF_LAYOUT_MAX], *forms[SF_LAYOUT_MAX], *units[SF_LAYOUT_MAX];
    const char *comments[SF_LAYOUT_MAX];
    char made[8]; /* TFORM of PSF_TERMS */
} sf_layout;      /* {0} is empty */

/* Append a column; the strings are borrowed. */
void sf_layout_add(sf_layout *l, const char *name, const char *form, const char *unit,
                   const char *comment);
/* Append the columns whose bits are in `columns`; PSF models have `terms`. *l must not move. */
void sf_layout_add_columns(sf_layout *l, unsigned columns, int terms);
/* Append carried columns, which are borrowed. */
void sf_layout_add_carried(sf_layout *l, const shear_carried *columns, int n);
