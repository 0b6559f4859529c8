/* SPDX-License-Identifier: GPL-3.0-or-later */
/* forget: take back a whole field. Its rows disappear with the first commit; the reply follows when
 * its contributions are removed, too (fields/field_purge.h). */
#include "base/buffer.h"
#include "base/cleanup.h"
#include "log/log.h"
#include "service/core/parts.h"
#include "service/fields/change_notifier.h"
#include "service/fields/estimates.h"
#include "service/fields/field_purge.h"
#include "service/jobs/rpc_errors.h"
#include "service/rpc/methods.h"

#include <inttypes.h>

typedef struct forget_reply {
    purge_waiter waiter; /* first */
    server_handle to;
    char field[STORE_FIELD_MAX + 1];
} forget_reply;

typedef struct forgotten_field {
    post_commit post; /* first */
    forget_reply *reply;
    buffer digests; /* of the removed rows, each with its final NUL */
} forgotten_field;

static void reply_purged(service *s, purge_waiter *w) {
    forget_reply *f = (forget_reply *)w;
    const sheard_reply reply = {.forget = {.field = f->field,
                                           .rows = w->numbers.rows,
                                           .contributions = w->numbers.contributions,
                                           .jobs = w->jobs}};
    server_reply(s->server, f->to, &reply);
    free(f);
}

/* The rows are removed, on disk: publish that, and remove the contributions. */
static void forgotten(post_commit *post, int code, const shear_error *err) {
    service *s = post->context;
    forgotten_field *f = (forgotten_field *)post;
    CLEANUP(release_free) forget_reply *reply = f->reply;
    CLEANUP(buffer_deinit) buffer digests = f->digests;
    if (code != SHEAR_OK) {
        sheard_rpc_error error;
        rpc_error_from_store(&error, code, err);
        server_reply_error(s->server, reply->to, &error);
        return;
    }
    log_notice("field '%s' is to be forgotten: %" PRId64 " contributions in %" PRId64 " rows",
               reply->field, reply->waiter.numbers.contributions, reply->waiter.numbers.rows);
    for (size_t at = 0; at < digests.n; at += strlen(digests.bytes + at) + 1)
        change_notifier_note(s, reply->field, digests.bytes + at);
    field_purge_wait(s, &CLEANUP_TAKE(reply)->waiter);
    field_purge_continue(s);
}

/* List the digests of the rows to be removed, for the change notifier. */
static int list_rows(service *s, const sheard_msg_forget *p, buffer *digests, shear_error *err) {
    CLEANUP(store_field_page_deinit) store_field_page page = {0};
    TRY(store_field_get(s->store, p->field, &page, err));
    for (size_t i = 0; i < page.n; i++) {
        const char *digest = page.fields[i].settings_digest;
        if (p->digest == NULL || strcmp(p->digest, digest) == 0)
            buffer_add(digests, digest, strlen(digest) + 1);
    }
    return digests->failed ? shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory") : SHEAR_OK;
}

static int forget(service *s, const server_request *r, shear_error *err) {
    const sheard_msg_forget *p = &r->request->params.forget;
    CLEANUP(buffer_deinit) buffer digests = {0};
    CLEANUP(release_free) forget_reply *reply = calloc(1, sizeof *reply);
    if (reply == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    reply->to = r->handle;
    reply->waiter.done = reply_purged;
    snprintf(reply->field, sizeof reply->field, "%s", p->field);
    TRY(list_rows(s, p, &digests, err));
    TRY(group_begin(&s->group, err));
    TRY(store_forget(s->store, p->field, p->digest, &reply->waiter.numbers, err));
    estimates_note_retraction(s);
    forgotten_field *f = group_then(&s->group, forgotten, 0, sizeof *f);
    if (f == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    f->reply = CLEANUP_TAKE(reply);
    f->digests = digests;
    digests = (buffer){0};
    return SHEAR_OK;
}

int method_forget(service *s, const server_request *r, sheard_rpc_error *error) {
    shear_error err = {0};
    return rpc_error_from_field(error, forget(s, r, &err), &err);
}
