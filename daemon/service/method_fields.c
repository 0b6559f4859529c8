/* SPDX-License-Identifier: GPL-3.0-or-later */
/* field, fields: looking at fields. */
#include "service/methods.h"

#include <stdlib.h>
#include <string.h>

static int list_contributions(service *s, const shear_msg_field *p, shear_msg_field_row *row,
                              store_contribution_page *page, shear_error *err) {
    if (p->limit == 0 || row->jobs == 0) {
        return SHEAR_OK;
    }
    const int code =
        store_contributions(s->store, p->field, row->digest, p->after, (size_t)p->limit, page, err);
    shear_msg_contribution *list = code == SHEAR_OK ? calloc(page->n + 1, sizeof *list) : NULL;
    for (size_t i = 0; list != NULL && i < page->n; i++) {
        const store_contribution *c = &page->items[i];
        list[i] = (shear_msg_contribution){.id = c->id,
                                           .job = c->job,
                                           .checksum = c->content,
                                           .n_stamps = c->n_stamps,
                                           .n_used = c->n_used,
                                           .counted_ms = c->counted_ms};
    }
    row->contributions = list;
    row->n_contributions = list != NULL ? page->n : 0;
    row->more = page->more;
    return code;
}

void method_field(service *s, const server_request *r) {
    const shear_msg_field *p = &r->request->params.field;
    store_field_page page = {0};
    shear_error err = {0};
    int code = store_field_get(s->store, p->field, &page, &err);
    if (code == STORE_NOT_FOUND) {
        method_refuse(s, r->handle, SHEAR_RPC_NO_SUCH_FIELD, err.message);
        return;
    }
    if (code == SHEAR_OK) {
        code = present_begun(s, p->field, &page, &err);
    }
    if (code == SHEAR_OK && !solutions_ready(s, r, &page, p->digest)) {
        store_field_page_deinit(&page);
        return;
    }
    shear_msg_field_row *rows = code == SHEAR_OK ? calloc(page.n + 1, sizeof *rows) : NULL;
    store_contribution_page *lists = rows != NULL ? calloc(page.n + 1, sizeof *lists) : NULL;
    size_t n = 0;
    for (size_t i = 0; lists != NULL && i < page.n && code == SHEAR_OK; i++) {
        if (p->digest == NULL || strcmp(p->digest, page.fields[i].settings_digest) == 0) {
            code = present_field(s, &page.fields[i], &rows[n], &err);
            if (code == SHEAR_OK) {
                code = list_contributions(s, p, &rows[n], &lists[n], &err);
                n++;
            }
        }
    }
    if (lists == NULL || code != SHEAR_OK) {
        method_refuse_store(s, r->handle, code != SHEAR_OK ? code : SHEAR_E_NOMEM, &err);
    } else {
        const shear_reply reply = {
            .field = {.field = p->field, .mixed = page.n > 1, .rows = rows, .n_rows = n}};
        server_reply(s->server, r->handle, &reply);
    }
    for (size_t i = 0; i < n; i++) {
        free((shear_msg_contribution *)rows[i].contributions);
        store_contribution_page_deinit(&lists[i]);
        present_field_free(&rows[i]);
    }
    free(rows);
    free(lists);
    store_field_page_deinit(&page);
}

/* A cursor of fields is the digest (32 hex digits), a blank and the name of the last one. */
static bool read_cursor(const char *cursor, char *digest, const char **name) {
    const char *blank = cursor != NULL ? strchr(cursor, ' ') : NULL;
    const size_t n = blank != NULL ? (size_t)(blank - cursor) : 0;
    if (n == 0 || n > STORE_DIGEST_MAX) {
        return false;
    }
    memcpy(digest, cursor, n);
    digest[n] = '\0';
    *name = blank + 1;
    return true;
}

void method_fields(service *s, const server_request *r) {
    const shear_msg_fields *p = &r->request->params.fields;
    store_field_page page = {0};
    shear_error err = {0};
    char digest[STORE_DIGEST_MAX + 1];
    char cursor[SHEAR_MSG_CURSOR_MAX];
    store_field_filter filter = {.prefix = p->prefix};
    if (p->cursor != NULL) {
        if (!read_cursor(p->cursor, digest, &filter.after_name)) {
            method_refuse(s, r->handle, SHEAR_RPC_BAD_CURSOR, "the cursor is none of this service");
            return;
        }
        filter.after_digest = digest;
    }
    const int code = store_fields(s->store, &filter, (size_t)p->limit, &page, &err);
    if (code == SHEAR_OK && !solutions_ready(s, r, &page, NULL)) {
        store_field_page_deinit(&page);
        return;
    }
    shear_msg_summary *list = code == SHEAR_OK ? calloc(page.n + 1, sizeof *list) : NULL;
    if (list == NULL) {
        method_refuse_store(s, r->handle, code != SHEAR_OK ? code : SHEAR_E_NOMEM, &err);
    } else {
        for (size_t i = 0; i < page.n; i++) {
            present_summary(s, &page.fields[i], &list[i]);
            list[i].mixed =
                (i > 0 && strcmp(page.fields[i - 1].name, page.fields[i].name) == 0) ||
                (i + 1 < page.n && strcmp(page.fields[i + 1].name, page.fields[i].name) == 0);
        }
        if (page.n > 0) {
            const store_field *last = &page.fields[page.n - 1];
            snprintf(cursor, sizeof cursor, "%s %s", last->settings_digest, last->name);
        }
        const shear_reply reply = {
            .fields = {.fields = list, .n_fields = page.n, .cursor = page.more ? cursor : NULL}};
        server_reply(s->server, r->handle, &reply);
    }
    free(list);
    store_field_page_deinit(&page);
}
