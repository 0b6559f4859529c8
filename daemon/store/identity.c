/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/identity.h"

#include "store/query.h"

int identity_find(store *s, const char *field, const char *settings_digest, const char *content,
                  identity_match *match, shear_error *err) {
    bool row = false;
    *match = (identity_match){0};
    if (field == NULL || content == NULL)
        return SHEAR_OK;
    CLEANUP(query_end) query q = query_on(s, SQL_COUNTED_FIND);
    query_text(&q, field);
    query_text(&q, settings_digest);
    query_text(&q, content);
    const int code = query_step(&q, &row, err);
    if (row) {
        match->job = query_get_int(&q);
        match->n_stamps = query_get_int(&q);
        match->n_used = query_get_int(&q);
    }
    return code;
}
