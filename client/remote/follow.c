/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/follow.h"

#include "remote/job_text.h"

#include "base/cleanup.h"
#include "base/clock.h"
#include "terminal/message.h"
#include "terminal/progress.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

/* Seconds of one wait request: the time after which a dead service is detected and, without
 * notifications, the interval of progress updates. */
static const double slice_s = 60.0;
static const double poll_s = 1.0;

typedef struct follow_state {
    service *service;
    const follow_options *options;
    follow_entry *entries; /* [n] */
    size_t n;
    progress *progress;
    bool notified; /* notifications are subscribed to */
    double deadline;
    follow_counts counts;
    text_table *ended; /* the results of finished jobs; unused with service.json */
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

static void note_job(follow_state *f, const sheard_msg_job *job) {
    follow_note(f->entries, f->n, job->id, job->state, &job->progress);
}

static void on_notice(void *context, const sheard_message *m) {
    follow_state *f = context;
    if (m->notice == SHEARD_NOTICE_JOB_CHANGED) {
        note_job(f, &m->params.job_changed.job);
    } else if (m->notice == SHEARD_NOTICE_JOB_PROGRESS) {
        follow_note(f->entries, f->n, m->params.job_progress.id, SHEARD_JOB_RUNNING,
                    &m->params.job_progress.progress);
    }
    show(f);
}

static size_t chunk_at(const follow_state *f, size_t first) {
    return f->n - first < SHEARD_MSG_LIST_MAX ? f->n - first : SHEARD_MSG_LIST_MAX;
}

/* Subscribe to notifications, which only update the bar: without them it shows the replies to
 * `wait`. A refusal (too many subscriptions) is not an error; a dead service will be detected
 * later. */
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

/* Add the jobs that have ended, or that have not ended in time. */
static void add_ended(follow_state *f, const sheard_msg_waited *waited) {
    for (size_t i = 0; i < waited->n_jobs; i++) {
        const sheard_msg_job *job = &waited->jobs[i];
        follow_counts_add(&f->counts, job->state);
        if (!f->service->json) {
            job_results_add(f->ended, job);
            job_complain(job);
        }
    }
}

/* Process the reply to a wait request. Returns whether to send another one: jobs are unfinished,
 * and there is time left. */
static bool note_answer(follow_state *f, const sheard_msg_waited *waited, const char *text) {
    for (size_t i = 0; i < waited->n_jobs; i++)
        note_job(f, &waited->jobs[i]);
    show(f);
    if (waited->timed_out && clock_s(CLOCK_MONOTONIC) < f->deadline)
        return true;
    if (f->options->answers && f->service->json)
        puts(text);
    add_ended(f, waited);
    return false;
}

/* Send one wait request; *again becomes the result of note_answer. */
static enum exit_code wait_once(follow_state *f, const int64_t *ids, size_t n, bool *again) {
    sheard_rpc_error error = {0};
    sheard_reply reply = {0};
    CLEANUP(release_free) char *text = NULL;
    sheard_params p;
    const double slice = progress_visible(f->progress) && !f->notified ? poll_s : slice_s;
    const double left = fmax(0.0, f->deadline - clock_s(CLOCK_MONOTONIC));
    sheard_params_init(&p, SHEARD_METHOD_WAIT);
    p.wait = (sheard_msg_wait){.ids = ids, .n_ids = n, .timeout_s = fmin(slice, left)};
    const enum connection_status status =
        connection_call(f->service->connection, SHEARD_METHOD_WAIT, &p,
                        p.wait.timeout_s + f->service->reply_timeout_s, &reply, &text, &error);
    if (status == CONNECTION_INTERRUPTED) {
        return message_fail(EXIT_CODE_OTHER,
                            "shearctl wait goes on waiting, shearctl cancel stops the jobs",
                            "interrupted; the jobs go on");
    }
    if (status == CONNECTION_OK) {
        *again = note_answer(f, &reply.wait, text);
        sheard_reply_deinit(&reply, SHEARD_METHOD_WAIT);
    }
    return service_say(status, &error);
}

static enum exit_code wait_all(follow_state *f, const int64_t *ids) {
    for (size_t first = 0; first < f->n; first += SHEARD_MSG_LIST_MAX) {
        bool again = true;
        while (again)
            TRY(wait_once(f, ids + first, chunk_at(f, first), &again));
    }
    return follow_exit_code(&f->counts);
}

static enum exit_code wait_with_progress(follow_state *f, const int64_t *ids) {
    f->progress = progress_begin("jobs", f->options->quiet);
    if (progress_visible(f->progress))
        subscribe(f, ids);
    const enum exit_code code = wait_all(f, ids);
    connection_listen(f->service->connection, NULL, NULL);
    progress_end(f->progress);
    return code;
}

enum exit_code follow_jobs(service *s, const int64_t *ids, size_t n,
                           const follow_options *options) {
    const double now = clock_s(CLOCK_MONOTONIC);
    CLEANUP(release_free) follow_entry *entries = calloc(n, sizeof *entries);
    if (entries == NULL)
        return message_no_memory();
    for (size_t i = 0; i < n; i++)
        entries[i] = (follow_entry){.id = ids[i], .progress = {.total = -1, .rate = NAN}};
    follow_state f = {
        .service = s,
        .options = options,
        .entries = entries,
        .n = n,
        .deadline = isnan(options->timeout_s) ? (double)INFINITY : now + options->timeout_s,
        .ended = job_results_new(),
    };
    enum exit_code code = wait_with_progress(&f, ids);
    if (!text_table_is_empty(f.ended) && text_table_print(f.ended, stdout) != EXIT_CODE_DONE)
        code = EXIT_CODE_OTHER;
    text_table_free(f.ended);
    return code;
}
