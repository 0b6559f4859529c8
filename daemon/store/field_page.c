/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read fields: all of one name, or a page of them. */
#include "store/page.h"

#include "base/cleanup.h"
#include "store/query.h"
#include "store/sums_text.h"

#include <stdlib.h>
#include <string.h>

static void deinit(store_field *f) {
    free(f->name);
    free(f->settings_digest);
    free(f->settings);
    free(f->sums);
}

void store_field_page_deinit(store_field_page *page) {
    for (size_t i = 0; i < page->n; i++)
        deinit(&page->fields[i]);
    free(page->fields);
    *page = (store_field_page){0};
}

store_field *store_field_page_find(const store_field_page *page, const char *settings_digest) {
    for (size_t i = 0; i < page->n; i++) {
        if (strcmp(page->fields[i].settings_digest, settings_digest) == 0)
            return &page->fields[i];
    }
    return NULL;
}

static int read_field(query *q, store_field *f, shear_error *err) {
    f->name = query_get_text(q);
    f->settings_digest = query_get_text(q);
    f->settings = query_get_text(q);
    CLEANUP(release_free) char *packed = query_get_text(q);
    f->jobs = query_get_int(q);
    f->n_stamps = query_get_int(q);
    f->n_used = query_get_int(q);
    f->unfinished = query_get_int(q);
    f->updated_ms = query_get_int(q);
    f->elapsed_us = query_get_int(q);
    TRY(query_got(q, err));
    return sums_unpack(packed, &f->sums, err);
}

/* Read records while their names begin with `prefix`; the page has capacity for limit + 1. */
static int read_page(query *q, const char *prefix, size_t limit, store_field_page *page,
                     shear_error *err) {
    const size_t length = strlen(prefix);
    bool row = false;
    int code = query_step(q, &row, err);
    while (row && code == SHEAR_OK && page->n <= limit) {
        store_field *f = &page->fields[page->n++];
        code = read_field(q, f, err);
        const bool matches = code == SHEAR_OK && strncmp(f->name, prefix, length) == 0;
        if (!matches || page->n > limit) {
            /* the record after the page's end */
            page->more = matches;
            deinit(f);
            page->n--;
            break;
        }
        code = query_step(q, &row, err);
    }
    return code;
}

static int allocate(size_t limit, store_field_page *page, shear_error *err) {
    *page = (store_field_page){0};
    page->fields = calloc(limit + 1, sizeof *page->fields);
    return page->fields != NULL ? SHEAR_OK : page_no_memory(err);
}

static int get_by_name(store *s, const char *name, store_field_page *page, shear_error *err) {
    CLEANUP(query_end) query q = query_on(s, SQL_FIELD_GET);
    query_text(&q, name);
    query_int(&q, STORE_PAGE_MAX + 1);
    TRY(read_page(&q, "", STORE_PAGE_MAX, page, err));
    query pending = query_on(s, SQL_FIELD_PENDING);
    query_text(&pending, name);
    int code = query_number(&pending, 0, &page->unfinished, err);
    if (code != SHEAR_OK || page->n > 0 || page->unfinished > 0)
        return code;
    return shear_fail(err, STORE_NOT_FOUND, "list the fields to see their names",
                      "there is no field '%.*s'", STORE_FIELD_MAX, name);
}

int store_field_get(store *s, const char *name, store_field_page *page, shear_error *err) {
    TRY(allocate(STORE_PAGE_MAX, page, err));
    int code = get_by_name(s, name, page, err);
    if (code != SHEAR_OK)
        store_field_page_deinit(page);
    return code;
}

int store_fields(store *s, const store_field_filter *filter, size_t limit, store_field_page *page,
                 shear_error *err) {
    const char *prefix = filter->prefix != NULL ? filter->prefix : "";
    const char *name = filter->after_name != NULL ? filter->after_name : "";
    const char *digest = filter->after_digest != NULL ? filter->after_digest : "";
    limit = page_limit(limit);
    TRY(allocate(limit, page, err));
    /* No digest is empty, so (prefix, "") precedes the first name that begins with the prefix. */
    const bool inside = strcmp(name, prefix) >= 0;
    CLEANUP(query_end) query q = query_on(s, SQL_FIELDS);
    query_text(&q, inside ? name : prefix);
    query_text(&q, inside ? digest : "");
    query_int(&q, (int64_t)limit + 1);
    int code = read_page(&q, prefix, limit, page, err);
    if (code != SHEAR_OK)
        store_field_page_deinit(page);
    return code;
}
