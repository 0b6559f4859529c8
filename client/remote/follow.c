/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/follow.h"

#include "remote/socket_io.h"
#include "terminal/message.h"
#include "terminal/progress.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

/* Seconds of one wait request: a service that is dead is noticed after so long; and, where there
 * are no notifications, how often the progress is looked at. */
static const double slice_s = 60.0;
static const double poll_s = 1.0;

typedef struct follow_state {
    service *service;
    const follow_options *options;
    follow_entry *entries; /* [n] */
    size_t n;
    progress *progress;
    bool notified; /* notifications come */
    double deadline;
    follow_tally tally;
} follow_state;

static void show(const follow_state *f) {
    char label[40];
    const follow_totals sum = follow_sum(f->entries, f->n);
    if (f->n == 1) {
        snprintf(label, sizeof label, "job %" PRId64, f->entries[0].id);
    } else {
        snprintf(label, sizeof label, "%zu of %zu jobs", sum.finished, f->n);
    }
    progress_show(f->progress, label, sum.done, sum.total, sum.rate);
}

static void on_notice(void *context, const sheard_message *m) {
    follow_state *f = context;
    if (m->notice == SHEARD_NOTICE_JOB_CHANGED) {
        follow_note_job(f->entries, f->n, &m->params.job_changed.job);
    } else if (m->notice == SHEARD_NOTICE_JOB_PROGRESS) {
        follow_note_progress(f->entries, f->n, m->params.job_progress.id,
                             &m->params.job_progress.progress);
    }
    show(f);
}

static size_t chunk_at(const follow_state *f, size_t first) {
    return f->n - first < SHEARD_MSG_LIST_MAX ? f->n - first : SHEARD_MSG_LIST_MAX;
}

/* Notifications are for the bar only: without them it is drawn from what wait answers. A service
 * that refuses them (too many subscriptions) is no error; one that is gone will be noticed. */
static void subscribe(follow_state *f, const int64_t *ids) {
    f->notified = true;
    connection_listen(f->service->connection, on_notice, f);
    for (size_t first = 0; f->notified && first < f->n; first += SHEARD_MSG_LIST_MAX) {
        sheard_rpc_error error = {0};
        sheard_params p;
        sheard_params_init(&p, SHEARD_METHOD_SUBSCRIBE);
        p.subscribe.jobs = ids + first;
        p.subscribe.n_jobs = chunk_at(f, first);
        p.subscribe.progress = true;
        f->notified =
            connection_call(f->service->connection, SHEARD_METHOD_SUBSCRIBE, &p,
                            f->service->reply_timeout_s, NULL, NULL, &error) == CONNECTION_OK;
    }
}

static void count(follow_state *f, const sheard_msg_waited *waited) {
    for (size_t i = 0; i < waited->n_jobs; i++) {
        const sheard_msg_job *job = &waited->jobs[i];
        f->tally.done += job->state == SHEARD_JOB_DONE;
        f->tally.failed += job->state == SHEARD_JOB_FAILED;
        f->tally.cancelled +=
            job->state == SHEARD_JOB_CANCELLED || job->state == SHEARD_JOB_RETRACTED;
        f->tally.unfinished += !sheard_job_state_is_final(job->state);
        if (f->options->ended != NULL) {
            f->options->ended(f->options->context, job);
        }
    }
}

/* One wait request. *again: neither are the jobs finished nor is the time over. */
static int wait_once(follow_state *f, const int64_t *ids, size_t n, bool *again) {
    sheard_rpc_error error = {0};
    sheard_reply reply = {0};
    char *text = NULL;
    sheard_params p;
    const double slice = progress_visible(f->progress) && !f->notified ? poll_s : slice_s;
    const double left = fmax(0.0, f->deadline - socket_io_now());
    sheard_params_init(&p, SHEARD_METHOD_WAIT);
    p.wait = (sheard_msg_wait){.ids = ids, .n_ids = n, .timeout_s = fmin(slice, left)};
    const int status =
        connection_call(f->service->connection, SHEARD_METHOD_WAIT, &p,
                        p.wait.timeout_s + f->service->reply_timeout_s, &reply, &text, &error);
    *again = false;
    if (status == CONNECTION_OK) {
        for (size_t i = 0; i < reply.wait.n_jobs; i++) {
            follow_note_job(f->entries, f->n, &reply.wait.jobs[i]);
        }
        show(f);
        *again = reply.wait.timed_out && socket_io_now() < f->deadline;
        if (!*again) {
            if (f->options->print && f->service->json) {
                puts(text);
            }
            count(f, &reply.wait);
        }
        sheard_reply_deinit(&reply, SHEARD_METHOD_WAIT);
    }
    free(text);
    if (status == CONNECTION_INTERRUPTED) {
        message_fail("shearctl wait goes on waiting, shearctl cancel stops the jobs",
                     "interrupted; the jobs go on");
        return EXIT_CODE_OTHER;
    }
    return service_say(status, &error);
}

static int wait_all(follow_state *f, const int64_t *ids) {
    int code = EXIT_CODE_DONE;
    for (size_t first = 0; code == SHEAR_OK && first < f->n; first += SHEARD_MSG_LIST_MAX) {
        bool again = true;
        while (code == SHEAR_OK && again) {
            code = wait_once(f, ids + first, chunk_at(f, first), &again);
        }
    }
    return code != SHEAR_OK ? code : follow_exit_code(&f->tally);
}

int follow_jobs(service *s, const int64_t *ids, size_t n, const follow_options *options) {
    follow_state f = {.service = s, .options = options, .n = n};
    f.deadline = isnan(options->timeout_s) ? (double)INFINITY : socket_io_now() + options->timeout_s;
    f.entries = calloc(n, sizeof *f.entries);
    if (f.entries == NULL) {
        message_fail(NULL, "out of memory");
        return EXIT_CODE_OTHER;
    }
    for (size_t i = 0; i < n; i++) {
        f.entries[i] = (follow_entry){.id = ids[i], .progress = {.total = -1, .rate = NAN}};
    }
    f.progress = options->quiet ? progress_begin_quiet() : progress_begin("jobs");
    if (progress_visible(f.progress)) {
        subscribe(&f, ids);
    }
    const int code = wait_all(&f, ids);
    connection_listen(s->connection, NULL, NULL);
    progress_end(f.progress);
    free(f.entries);
    return code;
}
