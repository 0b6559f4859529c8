/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/field_row.h: the row of one field as measured with one set of settings. */
#ifndef SHEARD_STORE_FIELD_ROW_H
#define SHEARD_STORE_FIELD_ROW_H

#include "store/database.h"

typedef struct field_row {
    int64_t id;   /* 0: nothing was counted */
    char *packed; /* its sums (sums_text.h) */
} field_row;

/* id 0 where there is no such row, which is no error. */
int field_row_get(store *s, const char *name, const char *settings_digest, field_row *field,
                  shear_error *err);
void field_row_deinit(field_row *field);

/* Its number alone. STORE_NOT_FOUND where there is no such row. */
int field_row_find(store *s, const char *name, const char *settings_digest, int64_t *id,
                   shear_error *err);

/* The stamp that counts most of all that was counted in the field, as a join of all would tell it,
 * and the account of its contribution (the caller's; NULL: not wanted). */
int field_row_top(store *s, int64_t field, shear_influence *top, char **account, shear_error *err);

#endif
