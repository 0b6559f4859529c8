/* SPDX-License-Identifier: GPL-3.0-or-later */
/* field, fields: show fields. */
#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/fields/estimates.h"
#include "service/fields/field_result.h"
#include "service/rpc/field_message.h"
#include "service/rpc/listing.h"
#include "service/rpc/methods.h"
#include "service/rpc/refuse.h"

#include <stdlib.h>
#include <string.h>

/* Return true if all results are available. False: they are being solved, or the error reply has
 * been sent. */
static bool have_estimates(const listing *l, const store_field_page *page, const char *digest,
                           int64_t since) {
    const enum estimates_answer answer = estimates_request(l->s, l->to, page, digest, since);
    if (answer == ESTIMATES_NO_MEMORY)
        refuse_with(l->s, l->to, SHEARD_RPC_OUT_OF_MEMORY, "out of memory for solving a field");
    return answer == ESTIMATES_READY;
}

/* ---- field: one row per step, or several steps per row while it looks for a culprit ---- */

typedef struct field_rows {
    listing list;          /* first */
    int64_t since;         /* see fields/estimates.h */
    store_field_page page; /* filled when all results are available */
    bool ready;
    size_t next;
    bool made; /* the following members belong to the next row */
    sheard_msg_field_row row;
    store_contribution_page contributions;
    no_result why;
} field_rows;

/* Load the rows, and request their results. */
static enum server_step find_rows(field_rows *w) {
    service *s = w->list.s;
    const sheard_msg_field *p = &w->list.request.params.field;
    shear_error err = {0};
    int code = store_field_get(s->store, p->field, &w->page, &err);
    if (code == STORE_NOT_FOUND) {
        refuse_with(s, w->list.to, SHEARD_RPC_NO_SUCH_FIELD, err.message);
        return SERVER_PAUSE;
    }
    code = code == SHEAR_OK ? field_result_add_rows(s, p->field, &w->page, &err) : code;
    if (code != SHEAR_OK) {
        refuse_store(w->list.s, w->list.to, code, &err);
        return SERVER_PAUSE;
    }
    w->ready = have_estimates(&w->list, &w->page, p->digest, w->since);
    if (w->ready)
        return SERVER_MORE;
    store_field_page_deinit(&w->page);
    return SERVER_PAUSE;
}

static int make_row(field_rows *w, const store_field *f, shear_error *err) {
    const sheard_msg_field *p = &w->list.request.params.field;
    w->made = true;
    if (p->limit > 0 && f->jobs > 0) {
        TRY(store_contributions(w->list.s->store, f->name, f->settings_digest, p->after,
                                (size_t)p->limit, &w->contributions, err));
    }
    return field_to_message(w->list.s, f, w->since, &w->contributions, &w->row, &w->why, err);
}

static void clear_row(field_rows *w) {
    field_message_deinit(&w->row);
    store_contribution_page_deinit(&w->contributions);
    no_result_deinit(&w->why);
    w->made = false;
}

/* Make the next row, or continue with it. */
static void row_step(field_rows *w, const store_field *f) {
    shear_error err = {0};
    const int code = w->made ? SHEAR_OK : make_row(w, f, &err);
    if (code != SHEAR_OK) {
        refuse_store(w->list.s, w->list.to, code, &err);
    } else if (no_result_look(&w->why, w->list.s->store, f)) {
        w->row.reason = w->why.text;
        w->row.culprit = (sheard_msg_culprit){.job = w->why.job,
                                              .contribution = w->why.contribution,
                                              .file = w->why.file,
                                              .checksum = w->why.checksum};
        (void)listing_add(&w->list, &w->row);
        clear_row(w);
        w->next++;
    }
}

static enum server_step rows_step(void *context) {
    field_rows *w = context;
    const sheard_msg_field *p = &w->list.request.params.field;
    if (!w->ready)
        return find_rows(w);
    if (w->next == w->page.n) {
        const sheard_reply rest = {.field = {.field = p->field, .mixed = w->page.n > 1}};
        listing_reply(&w->list, &rest);
        return SERVER_MORE;
    }
    const store_field *f = &w->page.fields[w->next];
    if (p->digest == NULL || strcmp(p->digest, f->settings_digest) == 0) {
        row_step(w, f);
    } else {
        w->next++;
    }
    return SERVER_MORE;
}

static void rows_drop(void *context) {
    field_rows *w = context;
    estimates_forget(w->list.s, w->list.to);
    clear_row(w);
    store_field_page_deinit(&w->page);
    listing_deinit(&w->list);
    free(w);
}

void method_field(service *s, const server_request *r) {
    field_rows *w = calloc(1, sizeof *w);
    if (w == NULL) {
        refuse_with(s, r->handle, SHEARD_RPC_OUT_OF_MEMORY, "out of memory for a field");
        return;
    }
    w->since = estimates_begun(s);
    listing_begin(&w->list, s, r, rows_step, rows_drop);
}

/* ---- fields: some in each step ---- */

enum { FIELDS_A_STEP = 16 };

typedef struct field_list {
    listing list;        /* first */
    int64_t since;       /* see fields/estimates.h */
    size_t left;         /* of the limit */
    char *name, *digest; /* of the last field, owned; NULL: none yet */
} field_list;

/* Parse a cursor: the digest (32 hexadecimal digits), a blank, and the name of the last field. */
static bool read_cursor(const char *cursor, char *digest, const char **name) {
    const char *blank = cursor != NULL ? strchr(cursor, ' ') : NULL;
    const size_t n = blank != NULL ? (size_t)(blank - cursor) : 0;
    if (n == 0 || n > STORE_DIGEST_MAX)
        return false;
    memcpy(digest, cursor, n);
    digest[n] = '\0';
    *name = blank + 1;
    return true;
}

static bool add_summary(field_list *w, const store_field_page *page, size_t i) {
    const char *name = page->fields[i].name;
    const char *before = i > 0 ? page->fields[i - 1].name : w->name;
    sheard_msg_summary summary;
    field_to_summary(w->list.s, &page->fields[i], w->since, &summary);
    summary.mixed = (before != NULL && strcmp(before, name) == 0) ||
                    (i + 1 < page->n && strcmp(page->fields[i + 1].name, name) == 0);
    return listing_add(&w->list, &summary);
}

/* Add the first n fields of the page. The page may have one more, which shows whether the last one
 * is mixed. */
static bool add_fields(field_list *w, const store_field_page *page, size_t n) {
    for (size_t i = 0; i < n; i++) {
        if (!add_summary(w, page, i))
            return false;
    }
    w->left -= n;
    if (n > 0) {
        free(w->name);
        free(w->digest);
        w->name = strdup(page->fields[n - 1].name);
        w->digest = strdup(page->fields[n - 1].settings_digest);
        if (w->name == NULL || w->digest == NULL) {
            refuse_with(w->list.s, w->list.to, SHEARD_RPC_OUT_OF_MEMORY,
                        "out of memory for a list of fields");
            return false;
        }
    }
    return true;
}

static void reply_with_fields(field_list *w, bool more) {
    char cursor[SHEARD_MSG_CURSOR_MAX];
    if (more)
        snprintf(cursor, sizeof cursor, "%s %s", w->digest, w->name);
    const sheard_reply rest = {.fields.cursor = more ? cursor : NULL};
    listing_reply(&w->list, &rest);
}

static enum server_step fields_step(void *context) {
    field_list *w = context;
    const size_t most = w->left < FIELDS_A_STEP ? w->left : FIELDS_A_STEP;
    const store_field_filter filter = {.prefix = w->list.request.params.fields.prefix,
                                       .after_name = w->name,
                                       .after_digest = w->digest};
    CLEANUP(store_field_page_deinit) store_field_page page = {0};
    shear_error err = {0};
    const int code = store_fields(w->list.s->store, &filter, most + 1, &page, &err);
    if (code != SHEAR_OK) {
        refuse_store(w->list.s, w->list.to, code, &err);
        return SERVER_MORE;
    }
    if (!have_estimates(&w->list, &page, NULL, w->since))
        return SERVER_PAUSE;
    if (add_fields(w, &page, page.n < most ? page.n : most) && (page.n <= most || w->left == 0))
        reply_with_fields(w, page.n > most);
    return SERVER_MORE;
}

static void fields_drop(void *context) {
    field_list *w = context;
    estimates_forget(w->list.s, w->list.to);
    listing_deinit(&w->list);
    free(w->name);
    free(w->digest);
    free(w);
}

void method_fields(service *s, const server_request *r) {
    const sheard_msg_fields *p = &r->request->params.fields;
    char digest[STORE_DIGEST_MAX + 1];
    const char *name = NULL;
    if (p->cursor != NULL && !read_cursor(p->cursor, digest, &name)) {
        refuse_with(s, r->handle, SHEARD_RPC_BAD_CURSOR, "the cursor is not from this service");
        return;
    }
    field_list *w = calloc(1, sizeof *w);
    if (w != NULL && name != NULL) {
        w->name = strdup(name);
        w->digest = strdup(digest);
    }
    if (w == NULL || (name != NULL && (w->name == NULL || w->digest == NULL))) {
        refuse_with(s, r->handle, SHEARD_RPC_OUT_OF_MEMORY, "out of memory for a list of fields");
        free(w);
        return;
    }
    w->since = estimates_begun(s);
    w->left = (size_t)p->limit;
    listing_begin(&w->list, s, r, fields_step, fields_drop);
}
