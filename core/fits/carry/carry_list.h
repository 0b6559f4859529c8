/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/carry/carry_list.h: which columns of a table are carried to results.
 *
 * A column whose name is one of a field file's or a result's own is called CAT_NAME there. */
#pragma once

#include "fits/header/table.h"
#include "shear/field.h"

typedef struct carry_list {
    shear_carried *columns;   /* [n] */
    char (*sources)[SF_NAME]; /* [n] their names in the table */
    int n, bytes;             /* bytes of a row of all */
} carry_list;

enum {
    CARRY_CELL = 64,                    /* bytes of a cell that is carried without being named */
    CARRY_NAMED_CELL = 4096,            /* and of one that is */
    CARRY_ROW = SHEAR_MAX_CARRIED_BYTES /* of a row */
};

/* Choose columns: "all" or NULL takes those of at most CARRY_CELL bytes that have a name, in their
 * order, as long as there is room; "none"; or NAME,... in any case. `of_field`: the table is a
 * field file's, whose own columns are known already and not carried; naming one is no error.
 * SHEAR_E_FORMAT: there is no such column, or it is too wide or of variable length; SHEAR_E_NOMEM.
 * Call carry_list_deinit after an error, too. */
int carry_list_init(carry_list *l, const sf_table *t, const char *names, bool of_field,
                    shear_error *err);
/* Keep the columns that another table has, too, in the same form, unit and scaling. `named`: all
 * must be there. */
int carry_list_match(carry_list *l, const sf_table *t, bool named, shear_error *err);
void carry_list_deinit(carry_list *l);

/* Return the column of the table that carried column `i` is from; NULL: none. */
const sf_column *carry_list_find(const carry_list *l, int i, const sf_table *t);
