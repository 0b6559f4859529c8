/* SPDX-License-Identifier: GPL-3.0-or-later */
/* field, fields: show fields. */
#include "base/cleanup.h"
#include "base/text.h"
#include "service/core/parts.h"
#include "service/fields/estimates.h"
#include "service/fields/field_message.h"
#include "service/fields/field_result.h"
#include "service/jobs/rpc_errors.h"
#include "service/rpc/listing.h"
#include "service/rpc/methods.h"

#include <string.h>

/* ---- field: one row per step, or several steps per row while it looks for a culprit ---- */

typedef struct field_rows {
    listing list;            /* first */
    int64_t since;           /* see fields/estimates.h */
    pending_request pending; /* for the results */
    store_field_page page;   /* filled when all results are available */
    bool ready;
    size_t next;
    bool made; /* the following members belong to the next row */
    sheard_msg_field_row row;
    store_contribution_page contributions;
    no_result why;
} field_rows;

/* Return SHEARD_RPC_OK if all results are available, LISTING_PAUSE if they are being solved, or the
 * code of *error. */
static int have_estimates(const listing *l, pending_request *pending, const store_field_page *page,
                          const char *digest, int64_t since, sheard_rpc_error *error) {
    pending->to = l->to;
    const int code = estimates_request(l->s, pending, page, digest, since, error);
    return code == ESTIMATES_PENDING ? LISTING_PAUSE : code;
}

static int load_rows(service *s, const char *field, store_field_page *page, shear_error *err) {
    TRY(store_field_get(s->store, field, page, err));
    return field_result_add_rows(s, field, page, err);
}

/* Load the rows, and request their results. */
static int find_rows(field_rows *w, sheard_rpc_error *error) {
    service *s = w->list.s;
    const sheard_msg_field *p = &w->list.request.params.field;
    shear_error err = {0};
    TRY(rpc_error_from_field(error, load_rows(s, p->field, &w->page, &err), &err));
    const int code = have_estimates(&w->list, &w->pending, &w->page, p->digest, w->since, error);
    w->ready = code == SHEARD_RPC_OK;
    if (!w->ready)
        store_field_page_deinit(&w->page);
    return code;
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
static int row_step(field_rows *w, const store_field *f, sheard_rpc_error *error) {
    shear_error err = {0};
    if (!w->made)
        TRY(rpc_error_from_store(error, make_row(w, f, &err), &err));
    if (!no_result_look(&w->why, w->list.s->store, f))
        return SHEARD_RPC_OK;
    w->row.reason = w->why.text;
    w->row.culprit = (sheard_msg_culprit){.job = w->why.job,
                                          .contribution = w->why.contribution,
                                          .file = w->why.file,
                                          .checksum = w->why.checksum};
    TRY(listing_add(&w->list, &w->row, error));
    clear_row(w);
    w->next++;
    return SHEARD_RPC_OK;
}

static int rows_step(listing *l, sheard_rpc_error *error) {
    field_rows *w = (field_rows *)l;
    const sheard_msg_field *p = &l->request.params.field;
    if (!w->ready)
        return find_rows(w, error);
    if (w->next == w->page.n) {
        const sheard_reply rest = {.field = {.field = p->field, .mixed = w->page.n > 1}};
        return listing_reply(l, &rest, error);
    }
    const store_field *f = &w->page.fields[w->next];
    if (p->digest == NULL || strcmp(p->digest, f->settings_digest) == 0)
        return row_step(w, f, error);
    w->next++;
    return SHEARD_RPC_OK;
}

static void rows_deinit(listing *l) {
    field_rows *w = (field_rows *)l;
    estimates_forget(l->s, &w->pending);
    clear_row(w);
    store_field_page_deinit(&w->page);
}

static const listing_kind fields_rows = {
    .what = "a field", .step = rows_step, .deinit = rows_deinit};

int method_field(service *s, const server_request *r, sheard_rpc_error *error) {
    field_rows *w = listing_new(s, r->handle, r->request, &fields_rows, sizeof *w, error);
    if (w == NULL)
        return error->code;
    w->since = s->estimates->begun;
    listing_begin(&w->list);
    return SHEARD_RPC_OK;
}

/* ---- fields: some in each step ---- */

enum { FIELDS_A_STEP = 16 };

typedef struct field_list {
    listing list;                                                       /* first */
    int64_t since;                                                      /* see fields/estimates.h */
    pending_request pending;                                            /* for the results */
    size_t left;                                                        /* of the limit */
    char name[SHEARD_MSG_CURSOR_MAX + 1], digest[STORE_DIGEST_MAX + 1]; /* of the last field; "":
                                                                           none yet */
} field_list;

/* Parse a cursor: the digest (32 hexadecimal digits), a blank, and the name of the last field. */
static bool read_cursor(const char *cursor, field_list *w) {
    const char *blank = strchr(cursor, ' ');
    const size_t n = blank != NULL ? (size_t)(blank - cursor) : 0;
    if (n == 0 || n > STORE_DIGEST_MAX)
        return false;
    text_set(w->digest, n + 1, cursor);
    text_set(w->name, sizeof w->name, blank + 1);
    return true;
}

static int add_summary(field_list *w, const store_field_page *page, size_t i,
                       sheard_rpc_error *error) {
    const char *name = page->fields[i].name;
    const char *before = i > 0 ? page->fields[i - 1].name : w->name;
    sheard_msg_summary summary;
    field_to_summary(w->list.s, &page->fields[i], w->since, &summary);
    summary.mixed = strcmp(before, name) == 0 ||
                    (i + 1 < page->n && strcmp(page->fields[i + 1].name, name) == 0);
    return listing_add(&w->list, &summary, error);
}

/* Add the first n fields of the page. The page may have one more, which shows whether the last one
 * is mixed. */
static int add_fields(field_list *w, const store_field_page *page, size_t n,
                      sheard_rpc_error *error) {
    for (size_t i = 0; i < n; i++)
        TRY(add_summary(w, page, i, error));
    w->left -= n;
    if (n > 0) {
        text_set(w->name, sizeof w->name, page->fields[n - 1].name);
        text_set(w->digest, sizeof w->digest, page->fields[n - 1].settings_digest);
    }
    return SHEARD_RPC_OK;
}

static int fields_step(listing *l, sheard_rpc_error *error) {
    field_list *w = (field_list *)l;
    const size_t most = w->left < FIELDS_A_STEP ? w->left : FIELDS_A_STEP;
    const store_field_filter filter = {.prefix = l->request.params.fields.prefix,
                                       .after_name = w->name,
                                       .after_digest = w->digest};
    CLEANUP(store_field_page_deinit) store_field_page page = {0};
    shear_error err = {0};
    char cursor[SHEARD_MSG_CURSOR_MAX];
    const int code = store_fields(l->s->store, &filter, most + 1, &page, &err);
    TRY(rpc_error_from_store(error, code, &err));
    TRY(have_estimates(l, &w->pending, &page, NULL, w->since, error));
    TRY(add_fields(w, &page, page.n < most ? page.n : most, error));
    if (page.n > most && w->left > 0)
        return SHEARD_RPC_OK;
    snprintf(cursor, sizeof cursor, "%s %.*s", w->digest, STORE_FIELD_MAX, w->name);
    const sheard_reply rest = {.fields.cursor = page.n > most ? cursor : NULL};
    return listing_reply(l, &rest, error);
}

static void fields_deinit(listing *l) {
    field_list *w = (field_list *)l;
    estimates_forget(l->s, &w->pending);
}

static const listing_kind field_lists = {
    .what = "a list of fields", .step = fields_step, .deinit = fields_deinit};

int method_fields(service *s, const server_request *r, sheard_rpc_error *error) {
    field_list *w = listing_new(s, r->handle, r->request, &field_lists, sizeof *w, error);
    if (w == NULL)
        return error->code;
    const sheard_msg_fields *p = &w->list.request.params.fields;
    w->since = s->estimates->begun;
    w->left = (size_t)p->limit;
    if (p->cursor != NULL && !read_cursor(p->cursor, w)) {
        listing_free(&w->list);
        return sheard_rpc_fail(error, SHEARD_RPC_BAD_CURSOR, NULL,
                               "the cursor is not from this service");
    }
    listing_begin(&w->list);
    return SHEARD_RPC_OK;
}
