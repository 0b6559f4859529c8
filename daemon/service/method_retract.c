/* SPDX-License-Identifier: GPL-3.0-or-later */
/* retract, forget: what was counted is taken back; answered when that is on disk. */
#include "service/methods.h"

#include <stdlib.h>
#include <string.h>

/* The fields' news, and the catalogues that are to go, come after the commit. */
static void reply_retracted(service *s, after *a, int code, const shear_error *err) {
    store_job job = {0};
    shear_error ignored;
    method_reply_job(s, a, code, err);
    if (code == SHEAR_OK) {
        catalogues_remove_retracted(s);
    }
    if (code == SHEAR_OK && store_job_get(s->store, a->job, &job, &ignored) == SHEAR_OK) {
        news_field_changed(s, job.field, job.settings_digest);
    }
    store_job_deinit(&job);
}

void method_retract(service *s, const server_request *r) {
    const int64_t id = r->request->params.id.id;
    shear_error err = {0};
    if (!method_may_change(s, r, id)) {
        return;
    }
    int code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_retract(s->store, id, &err);
    }
    after *a = code == SHEAR_OK ? group_after(s, reply_retracted) : NULL;
    if (code != SHEAR_OK || a == NULL) {
        method_refuse_store(s, r->handle, code != SHEAR_OK ? code : SHEAR_E_NOMEM, &err);
        return;
    }
    s->retractions++;
    a->to = r->handle;
    a->method = SHEAR_METHOD_RETRACT;
    a->job = id;
}

/* ---- whole fields ---- */

typedef struct forgotten {
    store_forgotten numbers;
    char *field;
    char *digests; /* of the rows that are gone, each with its NUL */
    size_t n_digests;
} forgotten;

static void forgotten_free(forgotten *f) {
    if (f != NULL) {
        free(f->field);
        free(f->digests);
        free(f);
    }
}

static void tell_rows(service *s, const forgotten *f) {
    const char *digest = f->digests;
    for (size_t i = 0; i < f->n_digests; i++) {
        news_field_changed(s, f->field, digest);
        digest += strlen(digest) + 1;
    }
}

static void reply_forgotten(service *s, after *a, int code, const shear_error *err) {
    forgotten *f = a->data;
    if (code != SHEAR_OK) {
        method_refuse_store(s, a->to, code, err);
    } else {
        const shear_reply reply = {.forget = {.field = f->field,
                                              .rows = f->numbers.rows,
                                              .contributions = f->numbers.contributions,
                                              .jobs = f->numbers.jobs}};
        log_notice("field '%s' is forgotten: %lld contributions", f->field,
                   (long long)f->numbers.contributions);
        server_reply(s->server, a->to, &reply);
        catalogues_remove_retracted(s);
        tell_rows(s, f);
    }
    forgotten_free(f);
}

/* The digests of the rows that will be gone, for the news. */
static int list_rows(service *s, const shear_msg_forget *p, forgotten *f, shear_error *err) {
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

static int forget(service *s, const shear_msg_forget *p, forgotten *f, shear_error *err) {
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
    after *a = code == SHEAR_OK ? group_after(s, reply_forgotten) : NULL;
    if (a != NULL) {
        s->retractions++;
        a->to = r->handle;
        a->data = f;
        return;
    }
    if (code == STORE_NOT_FOUND) {
        method_refuse(s, r->handle, SHEAR_RPC_NO_SUCH_FIELD, err.message);
    } else {
        method_refuse_store(s, r->handle, code != SHEAR_OK ? code : SHEAR_E_NOMEM, &err);
    }
    forgotten_free(f);
}
