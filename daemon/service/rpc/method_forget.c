/* SPDX-License-Identifier: GPL-3.0-or-later */
/* forget: a whole field is taken back. Its rows are gone for everybody with the first commit; then
 * its contributions leave, a few milliseconds of them in a group, for there may be very many, and
 * each takes its job's catalog along. The store keeps what is left to do: whoever waits for the
 * reply may go, and the service, too. */
#include "service/rpc/methods.h"

#include <stdlib.h>
#include <string.h>

struct forgotten {
    TAILQ_ENTRY(forgotten) link;
    server_handle to;
    store_forgotten numbers;
    int64_t jobs; /* retracted so far */
    char *field;
    char *digests; /* of the rows that are gone, each with its NUL */
    size_t n_digests;
};

static void forgotten_free(forgotten *f) {
    if (f != NULL) {
        free(f->field);
        free(f->digests);
        free(f);
    }
}

void forget_free(service *s) {
    for (forgotten *f; (f = TAILQ_FIRST(&s->forgotten)) != NULL;) {
        TAILQ_REMOVE(&s->forgotten, f, link);
        forgotten_free(f);
    }
}

/* ---- what is to leave ---- */

typedef struct slice {
    int64_t row; /* store_removal's */
    int64_t jobs;
    bool over;   /* that was all of the row */
    bool failed; /* a change that is tried again later */
    char *field; /* where it is over */
} slice;

/* Who has asked for it; NULL: that was before the start. */
static forgotten *find_asker(service *s, int64_t row) {
    forgotten *f;
    TAILQ_FOREACH(f, &s->forgotten, link) {
        if (row > f->numbers.last - f->numbers.rows && row <= f->numbers.last) {
            break;
        }
    }
    return f;
}

static void reply_forgotten(service *s, forgotten *f) {
    const sheard_reply reply = {.forget = {.field = f->field,
                                           .rows = f->numbers.rows,
                                           .contributions = f->numbers.contributions,
                                           .jobs = f->jobs}};
    server_reply(s->server, f->to, &reply);
    TAILQ_REMOVE(&s->forgotten, f, link);
    forgotten_free(f);
}

/* They have left on disk, too. */
static void have_left(service *s, after *a, int code, const shear_error *err) {
    (void)err;
    slice *done = a->data;
    s->forgetting = false;
    forgotten *f = code == SHEAR_OK ? find_asker(s, done->row) : NULL;
    if (f != NULL) {
        f->jobs += done->jobs;
        if (done->over && done->row == f->numbers.last) {
            reply_forgotten(s, f);
        }
    }
    if (code == SHEAR_OK && done->over) {
        log_notice("field '%s' is forgotten", done->field);
    }
    if (code == SHEAR_OK && !done->failed) {
        forget_go_on(s);
    }
    free(done->field);
    free(done);
}

static int take_one(service *s, slice *out, shear_error *err) {
    store_removal next;
    int code = store_next_removal(s->store, &next, err);
    if (code == SHEAR_OK && next.forgotten != 0) {
        const bool gone = next.contribution != 0 && catalog_leaves(s, &next);
        code = store_remove(s->store, &next, gone, err);
    }
    if (code == SHEAR_OK) {
        out->row = next.forgotten;
        out->jobs += next.kept;
        out->over = next.contribution == 0;
    }
    if (code == SHEAR_OK && out->over) {
        out->field = next.field;
        next.field = NULL;
    }
    store_removal_deinit(&next);
    return code;
}

static int take_some(service *s, slice *out, shear_error *err) {
    enum { SLICE_NS = 3000000 };
    const uint64_t end = uv_hrtime() + SLICE_NS;
    int code = group_begin(s, err);
    while (code == SHEAR_OK && !out->over && uv_hrtime() < end) {
        code = take_one(s, out, err);
    }
    return code;
}

static bool is_any_left(service *s) {
    store_removal next;
    shear_error ignored;
    store_next_removal(s->store, &next, &ignored);
    const bool any = next.forgotten != 0;
    store_removal_deinit(&next);
    return any;
}

void forget_go_on(service *s) {
    enum { SECONDS_MS = 5000 };
    shear_error err = {0};
    if (s->forgetting || s->state == SHEARD_SERVER_STOPPING || !is_any_left(s)) {
        return;
    }
    slice *next = calloc(1, sizeof *next);
    after *a = next != NULL ? group_after(s, have_left) : NULL;
    if (a == NULL) {
        free(next);
        return;
    }
    const int code = take_some(s, next, &err);
    next->failed = code != SHEAR_OK;
    if (next->failed) {
        problem_noted(s, "store", store_code_name(code), SECONDS_MS, err.message);
    }
    s->forgetting = true;
    a->data = next;
}

/* ---- the request ---- */

static void tell_rows(service *s, const forgotten *f) {
    const char *digest = f->digests;
    for (size_t i = 0; i < f->n_digests; i++) {
        news_field_changed(s, f->field, digest);
        digest += strlen(digest) + 1;
    }
}

/* It is gone for everybody. */
static void begun(service *s, after *a, int code, const shear_error *err) {
    forgotten *f = a->data;
    if (code != SHEAR_OK) {
        method_refuse_store(s, a->to, code, err);
        forgotten_free(f);
        return;
    }
    log_notice("field '%s' is to be forgotten: %lld contributions in %lld rows", f->field,
               (long long)f->numbers.contributions, (long long)f->numbers.rows);
    f->to = a->to;
    TAILQ_INSERT_TAIL(&s->forgotten, f, link);
    tell_rows(s, f);
    forget_go_on(s);
}

/* The digests of the rows that will be gone, for the news. */
static int list_rows(service *s, const sheard_msg_forget *p, forgotten *f, shear_error *err) {
    store_field_page page = {0};
    size_t size = 0;
    int code = store_field_get(s->store, p->field, &page, err);
    FILE *out = code == SHEAR_OK ? open_memstream(&f->digests, &size) : NULL;
    for (size_t i = 0; out != NULL && i < page.n; i++) {
        const char *digest = page.fields[i].settings_digest;
        if (p->digest == NULL || strcmp(p->digest, digest) == 0) {
            fwrite(digest, 1, strlen(digest) + 1, out);
            f->n_digests++;
        }
    }
    if (code == SHEAR_OK && (out == NULL || fclose(out) != 0)) {
        code = shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    }
    store_field_page_deinit(&page);
    return code;
}

static int forget(service *s, const sheard_msg_forget *p, forgotten *f, shear_error *err) {
    f->field = strdup(p->field);
    int code = f->field != NULL ? list_rows(s, p, f, err)
                                : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    if (code == SHEAR_OK) {
        code = group_begin(s, err);
    }
    return code == SHEAR_OK ? store_forget(s->store, p->field, p->digest, &f->numbers, err) : code;
}

void method_forget(service *s, const server_request *r) {
    shear_error err = {0};
    forgotten *f = calloc(1, sizeof *f);
    const int code = f != NULL ? forget(s, &r->request->params.forget, f, &err) : SHEAR_E_NOMEM;
    after *a = code == SHEAR_OK ? group_after(s, begun) : NULL;
    if (a != NULL) {
        s->retractions++;
        a->to = r->handle;
        a->data = f;
        return;
    }
    if (code == STORE_NOT_FOUND) {
        method_refuse(s, r->handle, SHEARD_RPC_NO_SUCH_FIELD, err.message);
    } else {
        method_refuse_store(s, r->handle, code != SHEAR_OK ? code : SHEAR_E_NOMEM, &err);
    }
    forgotten_free(f);
}
