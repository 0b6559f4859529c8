/* SPDX-License-Identifier: GPL-3.0-or-later */
/* job, jobs, wait: looking at jobs. */
#include "service/methods.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

void method_job(service *s, const server_request *r) {
    store_job job = {0};
    store_attempts attempts = {0};
    shear_error err = {0};
    const int64_t id = r->request->params.id.id;
    int code = store_job_get(s->store, id, &job, &err);
    if (code == SHEAR_OK) {
        code = store_attempts_get(s->store, id, &attempts, &err);
    }
    shear_msg_attempt *history = code == SHEAR_OK ? calloc(attempts.n + 1, sizeof *history) : NULL;
    if (history == NULL) {
        method_refuse_store(s, r->handle, code != SHEAR_OK ? code : SHEAR_E_NOMEM, &err);
    } else {
        for (size_t i = 0; i < attempts.n; i++) {
            const store_attempt *a = &attempts.attempts[i];
            history[i] = (shear_msg_attempt){.number = a->number,
                                             .started_ms = a->started_ms,
                                             .ended_ms = a->ended_ms,
                                             .ending = a->ending,
                                             .job_class = a->failure_class,
                                             .code = a->code,
                                             .message = a->message};
        }
        shear_reply reply = {.job = {.history = history, .n_history = attempts.n}};
        present_job(s, &job, &reply.job.job);
        server_reply(s->server, r->handle, &reply);
        present_job_free(&reply.job.job);
    }
    free(history);
    store_attempts_deinit(&attempts);
    store_job_deinit(&job);
}

void method_jobs(service *s, const server_request *r) {
    const shear_msg_jobs *p = &r->request->params.jobs;
    store_job_page page = {0};
    shear_error err = {0};
    char cursor[32];
    char *end = NULL;
    store_job_filter filter = {.states = p->states,
                               .field = p->field,
                               .by_owner = p->owner >= 0,
                               .owner = (uint32_t)(p->owner >= 0 ? p->owner : 0)};
    filter.before = p->cursor != NULL ? strtoll(p->cursor, &end, 10) : 0;
    if (p->cursor != NULL && (*end != '\0' || filter.before <= 0)) {
        method_refuse(s, r->handle, SHEAR_RPC_BAD_CURSOR, "the cursor is none of this service");
        return;
    }
    const int code = store_jobs(s->store, &filter, (size_t)p->limit, &page, &err);
    shear_msg_job *jobs = code == SHEAR_OK ? calloc(page.n + 1, sizeof *jobs) : NULL;
    if (jobs == NULL) {
        method_refuse_store(s, r->handle, code != SHEAR_OK ? code : SHEAR_E_NOMEM, &err);
    } else {
        for (size_t i = 0; i < page.n; i++) {
            present_job(s, &page.jobs[i], &jobs[i]);
            jobs[i].result = NULL;
        }
        snprintf(cursor, sizeof cursor, "%" PRId64, page.n > 0 ? page.jobs[page.n - 1].id : 0);
        const shear_reply reply = {
            .jobs = {.jobs = jobs, .n_jobs = page.n, .cursor = page.more ? cursor : NULL}};
        server_reply(s->server, r->handle, &reply);
        for (size_t i = 0; i < page.n; i++) {
            present_job_free(&jobs[i]);
        }
    }
    free(jobs);
    store_job_page_deinit(&page);
}

void method_wait(service *s, const server_request *r) {
    const shear_msg_wait *p = &r->request->params.wait;
    if (method_jobs_known(s, r, p->ids, p->n_ids)) {
        waits_add(s, r->handle, SHEAR_METHOD_WAIT, false, p->ids, p->n_ids, p->timeout_s);
    }
}
