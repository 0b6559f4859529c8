/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read a field's contributions, their sums, the truth they share, and the stamp that counts most.
 */
#include "store/field_row.h"

#include "base/cleanup.h"
#include "store/page.h"
#include "store/row.h"
#include "store/sums_text.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#define MEMBER(member) ROW_MEMBER(store_contribution, member)
static const row_type contribution_type =
    ROW_TYPE(store_contribution, MEMBER(id), MEMBER(job), MEMBER(content), MEMBER(n_stamps),
             MEMBER(n_used), MEMBER(counted_ms), MEMBER(account));

void store_contribution_page_deinit(store_contribution_page *page) {
    row_free(&contribution_type, page->items, page->n);
    *page = (store_contribution_page){0};
}

int store_contributions(store *s, const char *name, const char *settings_digest, int64_t after,
                        size_t limit, store_contribution_page *page, shear_error *err) {
    int64_t field = 0;
    *page = (store_contribution_page){0};
    limit = page_limit(limit);
    TRY(field_row_find(s, name, settings_digest, &field, err));
    page->items = calloc(limit + 1, sizeof *page->items);
    if (page->items == NULL)
        return page_no_memory(err);
    query q = QUERY(s, SQL_CONTRIBUTIONS, query_int(field), query_int(after),
                    query_int((int64_t)limit + 1));
    int code = row_list(q, &contribution_type, limit, page->items, &page->n, &page->more, err);
    if (code != SHEAR_OK)
        store_contribution_page_deinit(page);
    return code;
}

/* Read the least or greatest true shear of a field's contributions; NaN: there is none, or one
 * contribution has none. */
static int end_of_truths(store *s, enum sql which, int64_t field, double g[2], shear_error *err) {
    bool row = false;
    CLEANUP(query_end) query q = QUERY(s, which, query_int(field));
    TRY(query_step(&q, &row, err));
    g[0] = row ? query_get_real(&q) : NAN;
    g[1] = row ? query_get_real(&q) : NAN;
    return SHEAR_OK;
}

int store_field_truth(store *s, const char *name, const char *settings_digest, store_truth *truth,
                      shear_error *err) {
    int64_t field = 0;
    double least[2];
    double greatest[2];
    *truth = (store_truth){0};
    TRY(field_row_find(s, name, settings_digest, &field, err));
    TRY(end_of_truths(s, SQL_FIELD_LEAST_TRUTH, field, least, err));
    if (isnan(least[0]) || isnan(least[1]))
        return SHEAR_OK;
    TRY(end_of_truths(s, SQL_FIELD_GREATEST_TRUTH, field, greatest, err));
    if (least[0] == greatest[0] && least[1] == greatest[1])
        *truth = (store_truth){true, least[0], least[1]};
    return SHEAR_OK;
}

int store_field_top(store *s, const char *name, const char *settings_digest, shear_influence *top,
                    char **account, shear_error *err) {
    int64_t field = 0;
    *top = (shear_influence){.size = NAN, .stamp = -1};
    *account = NULL;
    TRY(field_row_find(s, name, settings_digest, &field, err));
    return field_row_top(s, field, top, account, err);
}

int store_contribution_sums(store *s, int64_t id, char **sums, shear_error *err) {
    bool row = false;
    *sums = NULL;
    CLEANUP(query_end) query q = QUERY(s, SQL_CONTRIBUTION_SUMS, query_int(id));
    TRY(query_step(&q, &row, err));
    if (!row)
        return shear_fail(err, STORE_NOT_FOUND, NULL, "there is no contribution %" PRId64, id);
    CLEANUP(release_free) char *packed = query_get_text(&q);
    TRY(query_got(&q, err));
    return sums_unpack(packed, sums, err);
}
