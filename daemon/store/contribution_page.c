/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read a field's contributions, their sums, the truth they share, and the stamp that counts most.
 */
#include "store/field_row.h"

#include "base/cleanup.h"
#include "store/page.h"
#include "store/query.h"
#include "store/sums_text.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

void store_contribution_page_deinit(store_contribution_page *page) {
    for (size_t i = 0; i < page->n; i++) {
        free(page->items[i].content);
        free(page->items[i].account);
    }
    free(page->items);
    *page = (store_contribution_page){0};
}

static void read_contribution(query *q, store_contribution *c) {
    c->id = query_get_int(q);
    c->job = query_get_int(q);
    c->content = query_get_text(q);
    c->n_stamps = query_get_int(q);
    c->n_used = query_get_int(q);
    c->counted_ms = query_get_int(q);
    c->account = query_get_text(q);
}

static int read_page(query *q, size_t limit, store_contribution_page *page, shear_error *err) {
    for (;;) {
        int code = query_step(q, &page->more, err);
        if (!page->more || page->n == limit)
            return code;
        read_contribution(q, &page->items[page->n++]);
        TRY(query_got(q, err));
    }
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
    CLEANUP(query_end) query q = query_on(s, SQL_CONTRIBUTIONS);
    query_int(&q, field);
    query_int(&q, after);
    query_int(&q, (int64_t)limit + 1);
    int code = read_page(&q, limit, page, err);
    if (code != SHEAR_OK)
        store_contribution_page_deinit(page);
    return code;
}

/* Read the least or greatest true shear of a field's contributions; *none: there is one without. */
static int end_of_truths(store *s, enum sql which, int64_t field, double g[2], bool *none,
                         shear_error *err) {
    bool row = false;
    bool null = true;
    *none = true;
    CLEANUP(query_end) query q = query_on(s, which);
    query_int(&q, field);
    const int code = query_step(&q, &row, err);
    if (row) {
        g[0] = query_get_real(&q, &null);
        g[1] = query_get_real(&q, none);
        *none = *none || null;
    }
    return code;
}

int store_field_truth(store *s, const char *name, const char *settings_digest, store_truth *truth,
                      shear_error *err) {
    int64_t field = 0;
    double least[2] = {0.0};
    double greatest[2] = {0.0};
    bool none = true;
    *truth = (store_truth){0};
    TRY(field_row_find(s, name, settings_digest, &field, err));
    int code = end_of_truths(s, SQL_FIELD_LEAST_TRUTH, field, least, &none, err);
    if (code != SHEAR_OK || none)
        return code;
    code = end_of_truths(s, SQL_FIELD_GREATEST_TRUTH, field, greatest, &none, err);
    if (!none && least[0] == greatest[0] && least[1] == greatest[1])
        *truth = (store_truth){true, least[0], least[1]};
    return code;
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
    CLEANUP(query_end) query q = query_on(s, SQL_CONTRIBUTION_SUMS);
    query_int(&q, id);
    TRY(query_step(&q, &row, err));
    if (!row)
        return shear_fail(err, STORE_NOT_FOUND, NULL, "there is no contribution %" PRId64, id);
    CLEANUP(release_free) char *packed = query_get_text(&q);
    TRY(query_got(&q, err));
    return sums_unpack(packed, sums, err);
}
