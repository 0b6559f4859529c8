/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How the attempts of jobs end: why they failed, when they are tried again, and who is told. */
#include "service/inner.h"

#include <string.h>

void ending_tell(service *s, const store_job *job) {
    catalog_forget(s, job);
    waits_job_ended(s, job->id);
    server_end_job(s->server, job->id);
}

/* The store has the job's new state: tell those who wait, and let its file follow. */
static void settled(service *s, after *a, int code, const shear_error *err) {
    store_job job = {0};
    shear_error ignored;
    if (code != SHEAR_OK) {
        log_error("job %lld: its end is not on disk (%s); it will run again", (long long)a->job,
                  err->message);
        s->strays = true;
        return;
    }
    if (store_job_get(s->store, a->job, &job, &ignored) != SHEAR_OK) {
        return;
    }
    spooled_end(s, &job);
    publish_job(s, &job);
    if (job.state == STORE_WAITING) {
        problem_job_waits(s, &job);
    }
    if (sheard_job_state_is_final(job.state)) {
        s->jobs_ended++;
        ending_tell(s, &job);
        if (job.outcome == STORE_COUNTED) {
            news_field_changed(s, job.field, job.settings_digest);
        }
        log_info("job %lld (%s): %s%s%s", (long long)job.id,
                 job.field != NULL ? job.field : "field unknown", store_state_name(job.state),
                 job.state == STORE_FAILED ? ": " : "",
                 job.state == STORE_FAILED && job.message != NULL ? job.message : "");
    }
    store_job_deinit(&job);
}

void ending_settle(service *s, int64_t id) {
    after *a = group_after(s, settled);
    if (a != NULL) {
        a->job = id;
    }
}

ending_reason ending_reason_of(const shear_error *error) {
    switch (error->code) {
    case READER_E_DIED:
    case READER_E_PROTOCOL:
        return (ending_reason){STORE_BUG, sheard_rpc_code_get(SHEARD_RPC_READER_CRASHED)->name};
    case ENGINE_E_CHANGED:
        return (ending_reason){STORE_TRANSIENT, sheard_rpc_code_get(SHEARD_RPC_FILE_CHANGED)->name};
    case ENGINE_E_MEMORY:
        return (ending_reason){STORE_DATA, sheard_rpc_code_get(SHEARD_RPC_MEMORY_BUDGET)->name};
    case READER_E_MEMORY:
        return (ending_reason){STORE_BUG, sheard_rpc_code_get(SHEARD_RPC_READER_MEMORY)->name};
    case READER_E_HUNG:
        return (ending_reason){STORE_BUG, sheard_rpc_code_get(SHEARD_RPC_READER_TIMEOUT)->name};
    case SHEAR_E_NOMEM:
    case SHEAR_E_IO:
    case SHEAR_E_FULL:
        return (ending_reason){STORE_TRANSIENT, shear_code_name(error->code)};
    case SHEAR_E_INTERNAL:
        return (ending_reason){STORE_BUG, shear_code_name(error->code)};
    default:
        return (ending_reason){STORE_DATA, shear_code_name(error->code)};
    }
}

/* A disk may be away, or full, for longer than any number of attempts: that is nothing of the
 * job's. */
static bool is_patient(const ending_reason *reason) {
    return strcmp(reason->name, sheard_rpc_code_get(SHEARD_RPC_ROOT_MISSING)->name) == 0 ||
           strcmp(reason->name, sheard_rpc_code_get(SHEARD_RPC_DISK_FULL)->name) == 0;
}

/* When to try again: a transient failure with doubling back-off and a limit, a bug once, bad data
 * never. */
static int64_t retry_at(const service *s, const ending_reason *reason, int64_t failures,
                        int64_t now) {
    const int class = reason->class;
    if (class == STORE_DATA || (class == STORE_BUG && failures >= 1) ||
        (class == STORE_TRANSIENT && failures + 1 >= s->config.retry.attempts &&
         !is_patient(reason))) {
        return STORE_NEVER;
    }
    int64_t delay = s->config.retry.first_delay_ms;
    for (int64_t i = 0; i < failures && delay < s->config.retry.max_delay_ms; i++) {
        delay *= 2;
    }
    return now + (delay < s->config.retry.max_delay_ms ? delay : s->config.retry.max_delay_ms);
}

void ending_fail(service *s, int64_t id, int64_t failures, ending_reason reason,
                 const shear_error *error) {
    const int64_t now = wall_ms();
    shear_error err = {0};
    enum store_state state = STORE_QUEUED;
    const store_failure f = {.failure_class = reason.class,
                             .code = reason.name,
                             .message = error->message[0] != '\0' ? error->message : reason.name,
                             .advice = error->advice[0] != '\0' ? error->advice : NULL,
                             .retry_at_ms = retry_at(s, &reason, failures, now),
                             .now_ms = now};
    int code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_fail(s->store, id, &f, &state, &err);
    }
    if (code == SHEAR_OK) {
        ending_settle(s, id);
    } else {
        log_error("job %lld: its failure cannot be stored: %s", (long long)id, err.message);
        s->strays = true;
    }
}
