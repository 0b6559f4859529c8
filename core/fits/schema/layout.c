/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/schema/layout.h"

#include "fits/schema/field_columns.h"

#include <assert.h>
#include <stdio.h>

void sf_layout_add(sf_layout *l, const char *name, const char *form, const char *unit,
                   const char *comment) {
    assert(l->n < SF_LAYOUT_MAX);
    l->names[l->n] = (char *)name; /* CFITSIO does not write to them */
    l->forms[l->n] = (char *)form;
    l->units[l->n] = (char *)unit;
    l->comments[l->n++] = comment;
}

void sf_layout_add_columns(sf_layout *l, unsigned columns, int terms) {
    snprintf(l->made, sizeof l->made, "%dD", terms);
    for (const sf_column_def *def = sf_column_defs; def < sf_column_defs + SF_COLUMNS; def++) {
        const char *form = def->repeat == 0 ? l->made : def->form;
        if ((columns & def->bit) != 0)
            sf_layout_add(l, def->name, form, def->unit, def->comment);
    }
}

void sf_layout_add_carried(sf_layout *l, const shear_carried *columns, int n) {
    static const char comment[] = "of the input's catalog";
    for (int i = 0; i < n; i++)
        sf_layout_add(l, columns[i].name, columns[i].form, columns[i].unit, comment);
}
