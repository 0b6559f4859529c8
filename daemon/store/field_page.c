/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read fields: all of one name, or a page of them. */
#include "store/page.h"

#include "base/cleanup.h"
#include "store/row.h"
#include "store/sums_text.h"

#include <stdlib.h>
#include <string.h>

/* The sums are read as packed, and unpacked then. */
#define FIELD(member) ROW_MEMBER(store_field, member)
static const row_type field_type = ROW_TYPE(
    store_field, FIELD(name), FIELD(settings_digest), FIELD(settings), FIELD(sums), FIELD(jobs),
    FIELD(n_stamps), FIELD(n_used), FIELD(unfinished), FIELD(updated_ms), FIELD(elapsed_us));

void store_field_page_deinit(store_field_page *page) {
    row_free(&field_type, page->fields, page->n);
    *page = (store_field_page){0};
}

store_field *store_field_page_find(const store_field_page *page, const char *settings_digest) {
    for (size_t i = 0; i < page->n; i++) {
        if (strcmp(page->fields[i].settings_digest, settings_digest) == 0)
            return &page->fields[i];
    }
    return NULL;
}

static int unpack(store_field *f, shear_error *err) {
    CLEANUP(release_free) char *packed = f->sums;
    return sums_unpack(packed, &f->sums, err);
}

/* Read at most `limit` records while their names begin with `prefix`. */
static int read_page(query *q, const char *prefix, size_t limit, store_field_page *page,
                     shear_error *err) {
    const size_t length = strlen(prefix);
    for (;;) {
        store_field f;
        bool found = false;
        TRY(row_next(q, &field_type, &f, &found, err));
        const bool matches = found && strncmp(f.name, prefix, length) == 0;
        if (!matches || page->n == limit) {
            page->more = matches;
            row_deinit(&field_type, &f);
            return SHEAR_OK;
        }
        page->fields[page->n++] = f;
        TRY(unpack(&page->fields[page->n - 1], err));
    }
}

static int allocate(size_t limit, store_field_page *page, shear_error *err) {
    *page = (store_field_page){0};
    page->fields = calloc(limit + 1, sizeof *page->fields);
    return page->fields != NULL ? SHEAR_OK : page_no_memory(err);
}

static int get_by_name(store *s, const char *name, store_field_page *page, shear_error *err) {
    CLEANUP(query_end)
    query q = QUERY(s, SQL_FIELD_GET, query_text(name), query_int(STORE_PAGE_MAX + 1));
    TRY(read_page(&q, "", STORE_PAGE_MAX, page, err));
    TRY(query_number(QUERY(s, SQL_FIELD_PENDING, query_text(name)), 0, &page->unfinished, err));
    if (page->n > 0 || page->unfinished > 0)
        return SHEAR_OK;
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
    CLEANUP(query_end)
    query q = QUERY(s, SQL_FIELDS, query_text(inside ? name : prefix),
                    query_text(inside ? digest : ""), query_int((int64_t)limit + 1));
    int code = read_page(&q, prefix, limit, page, err);
    if (code != SHEAR_OK)
        store_field_page_deinit(page);
    return code;
}
