/* SPDX-License-Identifier: GPL-3.0-or-later */
/* job, jobs: show jobs. */
#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/jobs/job_message.h"
#include "service/rpc/listing.h"
#include "service/rpc/methods.h"
#include "service/rpc/refuse.h"

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

void method_job(service *s, const server_request *r) {
    CLEANUP(store_job_deinit) store_job job = {0};
    CLEANUP(store_attempts_deinit) store_attempts attempts = {0};
    shear_error err = {0};
    const int64_t id = r->request->params.id.id;
    int code = store_job_get(s->store, id, &job, &err);
    code = code == SHEAR_OK ? store_attempts_get(s->store, id, &attempts, &err) : code;
    if (code != SHEAR_OK) {
        refuse_store(s, r->handle, code, &err);
        return;
    }
    CLEANUP(release_free) sheard_msg_attempt *history = history_of(&attempts);
    if (history == NULL) {
        refuse_with(s, r->handle, SHEARD_RPC_OUT_OF_MEMORY, "out of memory for a job");
        return;
    }
    sheard_reply reply = {.job = {.history = history, .n_history = attempts.n}};
    job_to_message(s, &job, &reply.job.job);
    server_reply(s->server, r->handle, &reply);
    job_message_deinit(&reply.job.job);
}

/* ---- jobs: in pages that fit into one step ---- */

enum { JOBS_A_STEP = 16 };

typedef struct job_list {
    listing list; /* first */
    store_job_filter filter;
    size_t left; /* of the limit */
} job_list;

static bool add_jobs(job_list *w, const store_job_page *page) {
    bool good = true;
    for (size_t i = 0; good && i < page->n; i++) {
        sheard_msg_job job;
        job_to_message(w->list.s, &page->jobs[i], &job);
        job.result = NULL;
        good = listing_add(&w->list, &job);
        job_message_deinit(&job);
    }
    w->filter.before = page->n > 0 ? page->jobs[page->n - 1].id : w->filter.before;
    w->left -= page->n;
    return good;
}

static enum server_step jobs_step(void *context) {
    job_list *w = context;
    CLEANUP(store_job_page_deinit) store_job_page page = {0};
    shear_error err = {0};
    char cursor[32];
    const int code = store_jobs(w->list.s->store, &w->filter,
                                w->left < JOBS_A_STEP ? w->left : JOBS_A_STEP, &page, &err);
    if (code != SHEAR_OK) {
        refuse_store(w->list.s, w->list.to, code, &err);
    } else if (add_jobs(w, &page) && (!page.more || w->left == 0)) {
        snprintf(cursor, sizeof cursor, "%" PRId64, w->filter.before);
        const sheard_reply rest = {.jobs.cursor = page.more ? cursor : NULL};
        listing_reply(&w->list, &rest);
    }
    return SERVER_MORE;
}

static void jobs_drop(void *context) {
    job_list *w = context;
    listing_deinit(&w->list);
    free(w);
}

void method_jobs(service *s, const server_request *r) {
    const sheard_msg_jobs *p = &r->request->params.jobs;
    char *end = NULL;
    const int64_t before = p->cursor != NULL ? strtoll(p->cursor, &end, 10) : 0;
    if (p->cursor != NULL && (*end != '\0' || before <= 0)) {
        refuse_with(s, r->handle, SHEARD_RPC_BAD_CURSOR, "the cursor is not from this service");
        return;
    }
    job_list *w = calloc(1, sizeof *w);
    if (w == NULL) {
        refuse_with(s, r->handle, SHEARD_RPC_OUT_OF_MEMORY, "out of memory for a list of jobs");
        return;
    }
    w->filter = (store_job_filter){.states = p->states,
                                   .field = p->field,
                                   .by_owner = p->owner >= 0,
                                   .owner = (uint32_t)(p->owner >= 0 ? p->owner : 0),
                                   .before = before};
    w->left = (size_t)p->limit;
    listing_begin(&w->list, s, r, jobs_step, jobs_drop);
}
