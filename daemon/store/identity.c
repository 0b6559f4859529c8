/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/identity.h"

#include "store/row.h"

#define MATCH(member) ROW_MEMBER(identity_match, member)
static const row_type match_type =
    ROW_TYPE(identity_match, MATCH(job), MATCH(n_stamps), MATCH(n_used));

int identity_find(store *s, const char *field, const char *settings_digest, const char *content,
                  identity_match *match, shear_error *err) {
    *match = (identity_match){0};
    if (field == NULL || content == NULL)
        return SHEAR_OK;
    return row_get(QUERY(s, SQL_COUNTED_FIND, query_text(field), query_text(settings_digest),
                         query_text(content)),
                   &match_type, match, NULL, err);
}
