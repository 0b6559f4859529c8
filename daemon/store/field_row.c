/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/field_row.h"

#include "store/query.h"

#include <math.h>
#include <stdlib.h>

int field_row_get(store *s, const char *name, const char *settings_digest, field_row *field,
                  shear_error *err) {
    bool row = false;
    *field = (field_row){0};
    CLEANUP(query_end) query q = query_on(s, SQL_FIELD_FIND);
    query_text(&q, name);
    query_text(&q, settings_digest);
    const int code = query_step(&q, &row, err);
    if (!row)
        return code;
    field->id = query_get_int(&q);
    field->packed = query_get_text(&q);
    return query_got(&q, err);
}

void field_row_deinit(field_row *field) {
    free(field->packed);
    *field = (field_row){0};
}

int field_row_find(store *s, const char *name, const char *settings_digest, int64_t *id,
                   shear_error *err) {
    query q = query_on(s, SQL_FIELD_FIND);
    query_text(&q, name);
    query_text(&q, settings_digest);
    const int code = query_number(&q, 0, id, err);
    if (code != SHEAR_OK || *id != 0)
        return code;
    return shear_fail(err, STORE_NOT_FOUND, "list the fields to see their names and settings",
                      "there is no field '%.*s' with these settings", STORE_FIELD_MAX, name);
}

int field_row_top(store *s, int64_t field, shear_influence *top, char **account, shear_error *err) {
    bool row = false;
    bool null = false;
    *top = (shear_influence){0};
    CLEANUP(query_end) query q = query_on(s, SQL_FIELD_TOP);
    query_int(&q, field);
    const int code = query_step(&q, &row, err);
    if (!row)
        return code;
    top->size = query_get_real(&q, &null);
    top->stamp = query_get_int(&q);
    if (null)
        *top = (shear_influence){.size = NAN, .stamp = -1};
    if (account != NULL)
        *account = query_get_text(&q);
    return query_got(&q, err);
}
