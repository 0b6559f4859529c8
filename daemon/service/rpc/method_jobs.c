/* SPDX-License-Identifier: GPL-3.0-or-later */
/* job, jobs: show jobs. */
#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/jobs/job_message.h"
#include "service/jobs/rpc_errors.h"
#include "service/rpc/listing.h"
#include "service/rpc/methods.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* Return [attempts->n] attempts, malloc'd, or NULL if out of memory. */
static sheard_msg_attempt *history_of(const store_attempts *attempts) {
    sheard_msg_attempt *history = calloc(attempts->n + 1, sizeof *history);
    for (size_t i = 0; history != NULL && i < attempts->n; i++) {
        const store_attempt *a = &attempts->attempts[i];
        history[i] = (sheard_msg_attempt){.number = a->number,
                                          .started_ms = a->started_ms,
                                          .ended_ms = a->ended_ms,
                                          .outcome = (enum sheard_attempt_outcome)a->outcome,
                                          .job_class = (enum sheard_job_class)a->failure_class,
                                          .code = a->code,
                                          .message = a->message};
    }
    return history;
}

static int load_job(service *s, int64_t id, store_job *job, store_attempts *attempts,
                    shear_error *err) {
    TRY(store_job_get(s->store, id, job, err));
    return store_attempts_get(s->store, id, attempts, err);
}

int method_job(service *s, const server_request *r, sheard_rpc_error *error) {
    CLEANUP(store_job_deinit) store_job job = {0};
    CLEANUP(store_attempts_deinit) store_attempts attempts = {0};
    shear_error err = {0};
    const int code = load_job(s, r->request->params.id.id, &job, &attempts, &err);
    TRY(rpc_error_from_store(error, code, &err));
    CLEANUP(release_free) sheard_msg_attempt *history = history_of(&attempts);
    if (history == NULL)
        return sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "out of memory for a job");
    sheard_reply reply = {.job = {.history = history, .n_history = attempts.n}};
    job_to_message(s, &job, &reply.job.job);
    server_reply(s->server, r->handle, &reply);
    job_message_deinit(&reply.job.job);
    return SHEARD_RPC_OK;
}

/* ---- jobs: in pages that fit into one step ---- */

enum { JOBS_A_STEP = 16 };

typedef struct job_list {
    listing list; /* first */
    store_job_filter filter;
    size_t left; /* of the limit */
} job_list;

static int add_job(job_list *w, const store_job *job, sheard_rpc_error *error) {
    CLEANUP(job_message_deinit) sheard_msg_job message = {0};
    job_to_message(w->list.s, job, &message);
    message.result = NULL;
    return listing_add(&w->list, &message, error);
}

static int jobs_step(listing *l, sheard_rpc_error *error) {
    job_list *w = (job_list *)l;
    CLEANUP(store_job_page_deinit) store_job_page page = {0};
    shear_error err = {0};
    char cursor[32];
    const int code = store_jobs(l->s->store, &w->filter,
                                w->left < JOBS_A_STEP ? w->left : JOBS_A_STEP, &page, &err);
    TRY(rpc_error_from_store(error, code, &err));
    for (size_t i = 0; i < page.n; i++)
        TRY(add_job(w, &page.jobs[i], error));
    w->filter.before = page.n > 0 ? page.jobs[page.n - 1].id : w->filter.before;
    w->left -= page.n;
    if (page.more && w->left > 0)
        return SHEARD_RPC_OK;
    snprintf(cursor, sizeof cursor, "%" PRId64, w->filter.before);
    const sheard_reply rest = {.jobs.cursor = page.more ? cursor : NULL};
    return listing_reply(l, &rest, error);
}

static const listing_kind job_lists = {.what = "a list of jobs", .step = jobs_step};

int method_jobs(service *s, const server_request *r, sheard_rpc_error *error) {
    const sheard_msg_jobs *p = &r->request->params.jobs;
    char *end = NULL;
    const int64_t before = p->cursor != NULL ? strtoll(p->cursor, &end, 10) : 0;
    if (p->cursor != NULL && (*end != '\0' || before <= 0)) {
        return sheard_rpc_fail(error, SHEARD_RPC_BAD_CURSOR, NULL,
                               "the cursor is not from this service");
    }
    const store_job_filter filter = {.states = p->states,
                                     .field = p->field,
                                     .by_owner = p->owner >= 0,
                                     .owner = (uint32_t)(p->owner >= 0 ? p->owner : 0),
                                     .before = before};
    const size_t limit = (size_t)p->limit;
    job_list *w = listing_new(s, r->handle, r->request, &job_lists, sizeof *w, error);
    if (w == NULL)
        return error->code;
    w->filter = filter;
    w->left = limit;
    listing_begin(&w->list);
    return SHEARD_RPC_OK;
}
