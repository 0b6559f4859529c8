/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/job_outcome.h"

#include "base/cleanup.h"
#include "log/log.h"
#include "service/core/clock.h"
#include "service/core/parts.h"
#include "service/jobs/active_jobs.h"
#include "service/jobs/catalogs.h"
#include "service/jobs/job_message.h"
#include "sheard/rpc.h"

#include <inttypes.h>
#include <string.h>

/* ---- notification ---- */

void job_outcome_tell(service *s, const store_job *job) {
    catalog_forget(s, job);
    s->hooks->job_ended(s, job);
    server_end_job(s->server, job->id);
}

/* It is the same problem as long as one failed attempt follows another. */
static void note_waiting(service *s, const store_job *job) {
    char time[SHEARD_TIME_SIZE];
    const char *code = job->code != NULL ? job->code : "unknown";
    const char *message = job->message != NULL ? job->message : code;
    problem_note_add(&s->notes, "jobs", code, 2 * s->config.retry.max_delay_ms + 60000, message);
    if (problem_note_may_log(&s->notes, "jobs", code)) {
        log_warning("job %" PRId64 " (%s) waits: %s (%s, attempt %" PRId64
                    "); it is tried again at %s",
                    job->id, job->field != NULL ? job->field : "field unknown", message, code,
                    job->attempts, sheard_time_format(job->not_before_ms, time));
    }
}

static void tell_final(service *s, const store_job *job) {
    const bool failed = job->state == STORE_FAILED;
    s->jobs->ended++;
    job_outcome_tell(s, job);
    if (job->outcome == STORE_COUNTED)
        s->hooks->job_counted(s, job);
    log_info("job %" PRId64 " (%s): %s%s%s", job->id,
             job->field != NULL ? job->field : "field unknown", store_state_name(job->state),
             failed ? ": " : "", failed && job->message != NULL ? job->message : "");
}

/* The job's new state is on disk: move its file, then notify clients and subscribers. */
static void settled(post_commit *post, int code, const shear_error *err) {
    service *s = post->context;
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error failure;
    if (code != SHEAR_OK) {
        log_error("job %" PRId64 ": its end is not on disk (%s); it will run again", post->job,
                  err->message);
        s->jobs->may_have_orphans = true;
        return;
    }
    if (store_job_get(s->store, post->job, &job, &failure) != SHEAR_OK) {
        log_error("job %" PRId64 " has ended, but its effects are not carried out: %s", post->job,
                  failure.message);
        return;
    }
    s->hooks->dispose_file(s, &job);
    job_message_publish(s, &job);
    if (job.state == STORE_WAITING)
        note_waiting(s, &job);
    if (store_state_is_final(job.state))
        tell_final(s, &job);
}

void job_outcome_settle(service *s, int64_t id) {
    if (group_then(&s->group, settled, id, sizeof(post_commit)) == NULL)
        log_error("job %" PRId64 ": no memory to carry out the effects of its end", id);
}

/* ---- failures ---- */

failure_reason job_outcome_reason(const shear_error *error) {
    static const struct {
        int code;
        enum store_class class;
        int rpc;
    } reasons[] = {{READER_E_DIED, STORE_BUG, SHEARD_RPC_READER_CRASHED},
                   {READER_E_PROTOCOL, STORE_BUG, SHEARD_RPC_READER_CRASHED},
                   {READER_E_MEMORY, STORE_BUG, SHEARD_RPC_READER_MEMORY},
                   {READER_E_HUNG, STORE_BUG, SHEARD_RPC_READER_TIMEOUT},
                   {ENGINE_E_CHANGED, STORE_TRANSIENT, SHEARD_RPC_FILE_CHANGED},
                   {ENGINE_E_MEMORY, STORE_DATA, SHEARD_RPC_MEMORY_BUDGET},
                   {SHEAR_E_NOMEM, STORE_TRANSIENT, SHEARD_RPC_OUT_OF_MEMORY},
                   {SHEAR_E_IO, STORE_TRANSIENT, SHEARD_RPC_IO},
                   {SHEAR_E_FULL, STORE_TRANSIENT, SHEARD_RPC_DISK_FULL},
                   {SHEAR_E_INTERNAL, STORE_BUG, SHEARD_RPC_INTERNAL}};
    for (size_t i = 0; i < sizeof reasons / sizeof *reasons; i++) {
        if (error->code == reasons[i].code)
            return (failure_reason){reasons[i].class, sheard_rpc_code_get(reasons[i].rpc)->name};
    }
    return (failure_reason){STORE_DATA, shear_code_name(error->code)};
}

/* A disk may be missing or full for longer than any number of attempts, which is not the job's
 * fault. */
static bool is_patient(const failure_reason *reason) {
    return strcmp(reason->name, sheard_rpc_code_get(SHEARD_RPC_ROOT_MISSING)->name) == 0 ||
           strcmp(reason->name, sheard_rpc_code_get(SHEARD_RPC_DISK_FULL)->name) == 0;
}

/* Return true if the job is not tried again: a transient failure is retried a limited number of
 * times, a bug once, bad data never. */
static bool is_last(const service *s, const failure_reason *reason, int64_t failures) {
    switch (reason->class) {
    case STORE_TRANSIENT:
        return failures + 1 >= s->config.retry.attempts && !is_patient(reason);
    case STORE_BUG:
        return failures >= 1;
    default:
        return true;
    }
}

/* Return when the job is tried again, with doubling delays, or STORE_NEVER. */
static int64_t retry_at(const service *s, const failure_reason *reason, int64_t failures,
                        int64_t now) {
    const int64_t most = s->config.retry.max_delay_ms;
    int64_t delay = s->config.retry.first_delay_ms;
    if (is_last(s, reason, failures))
        return STORE_NEVER;
    for (int64_t i = 0; i < failures && delay < most; i++)
        delay *= 2;
    return now + (delay < most ? delay : most);
}

void job_outcome_fail(service *s, int64_t id, int64_t failures, failure_reason reason,
                      const shear_error *error) {
    const int64_t now = clock_wall_ms();
    shear_error err = {0};
    enum store_state state = STORE_QUEUED;
    const store_failure f = {.failure_class = reason.class,
                             .code = reason.name,
                             .message = error->message[0] != '\0' ? error->message : reason.name,
                             .advice = error->advice[0] != '\0' ? error->advice : NULL,
                             .retry_at_ms = retry_at(s, &reason, failures, now),
                             .now_ms = now};
    if (group_begin(&s->group, &err) != SHEAR_OK ||
        store_fail(s->store, id, &f, &state, &err) != SHEAR_OK) {
        log_error("job %" PRId64 ": its failure cannot be stored: %s", id, err.message);
        s->jobs->may_have_orphans = true;
        return;
    }
    job_outcome_settle(s, id);
}
