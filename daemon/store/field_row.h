/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/field_row.h: the row of one field with one set of settings. */
#pragma once

#include "store/database.h"

typedef struct field_row {
    int64_t id;   /* 0: there is no such row */
    char *packed; /* its sums (sums_text.h), owned */
} field_row;

/* Read the row. If there is none, *field is zeroed, which is not an error. */
int field_row_get(store *s, const char *name, const char *settings_digest, field_row *field,
                  shear_error *err);
void field_row_deinit(field_row *field);

/* Find the row's id. STORE_NOT_FOUND if there is none. */
int field_row_find(store *s, const char *name, const char *settings_digest, int64_t *id,
                   shear_error *err);

/* Find the stamp that counts most among the field's contributions, the same as a join of them all
 * would have. *account is the account of its contribution, the caller's; `account` NULL: not
 * wanted. */
int field_row_top(store *s, int64_t field, shear_influence *top, char **account, shear_error *err);
