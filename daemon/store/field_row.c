/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/field_row.h"

#include "store/row.h"

#include <math.h>

static const row_type field_row_type =
    ROW_TYPE(field_row, ROW_MEMBER(field_row, id), ROW_MEMBER(field_row, packed));

static query find(store *s, const char *name, const char *settings_digest) {
    return QUERY(s, SQL_FIELD_FIND, query_text(name), query_text(settings_digest));
}

int field_row_get(store *s, const char *name, const char *settings_digest, field_row *field,
                  shear_error *err) {
    return row_get(find(s, name, settings_digest), &field_row_type, field, NULL, err);
}

void field_row_deinit(field_row *field) {
    row_deinit(&field_row_type, field);
}

int field_row_find(store *s, const char *name, const char *settings_digest, int64_t *id,
                   shear_error *err) {
    TRY(query_number(find(s, name, settings_digest), 0, id, err));
    if (*id != 0)
        return SHEAR_OK;
    return shear_fail(err, STORE_NOT_FOUND, "list the fields to see their names and settings",
                      "there is no field '%.*s' with these settings", STORE_FIELD_MAX, name);
}

int field_row_top(store *s, int64_t field, shear_influence *top, char **account, shear_error *err) {
    bool row = false;
    *top = (shear_influence){0};
    CLEANUP(query_end) query q = QUERY(s, SQL_FIELD_TOP, query_int(field));
    const int code = query_step(&q, &row, err);
    if (!row)
        return code;
    top->size = query_get_real(&q);
    top->stamp = query_get_int(&q);
    if (isnan(top->size))
        top->stamp = -1;
    if (account != NULL)
        *account = query_get_text(&q);
    return query_got(&q, err);
}
