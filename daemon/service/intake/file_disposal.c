/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/intake/file_disposal.h"

#include "base/cleanup.h"
#include "log/log.h"
#include "service/core/clock.h"
#include "service/core/parts.h"
#include "service/jobs/job_message.h"
#include "service/jobs/spooled_file.h"
#include "shear/version.h"

#include <inttypes.h>

void file_disposal_put_off(service *s, const char *active_name, const char *code,
                           const char *message) {
    const int64_t interval_ms = s->config.spool.scan_interval_ms;
    shear_error ignored;
    problem_note_add(&s->notes, "spool", code, 3 * interval_ms + 60000, message);
    if (problem_note_may_log(&s->notes, "spool", code)) {
        log_warning("the file %s waits in active/: %s; it is tried again within %.3g s",
                    active_name, message, 1e-3 * (double)interval_ms);
    }
    spool_refuse(s->spool, active_name, &ignored);
}

/* Write the report and move the file to done/ or failed/. After an error the file stays in active/
 * and is reported again. */
static void move(service *s, const char *active_name, bool good, const sheard_msg_side *side,
                 spool_place *place) {
    CLEANUP(release_free) char *text = NULL;
    sheard_rpc_error error;
    shear_error err = {0};
    int code = sheard_side_text(&text, side, &error) == SHEARD_RPC_OK ? SHEAR_OK : SHEAR_E_NOMEM;
    code = code == SHEAR_OK ? spool_dispose(s->spool, active_name, good, text, place, &err) : code;
    /* Try twice: the file may have been moved, with only an fsync missing, and is then not reported
     * again. */
    if (code == SHEAR_E_IO) {
        spool_place again;
        code = spool_dispose(s->spool, active_name, good, text, &again, &err);
        *place = again.name[0] != '\0' ? again : *place;
    }
    if (code != SHEAR_OK)
        file_disposal_put_off(s, active_name, store_code_name(code), err.message);
}

/* Store the file's place. It is a convenience: a failure is only logged. */
static void keep_place(service *s, store_job *job, const spool_place *place) {
    shear_error err = {0};
    if (place->name[0] == '\0') {
        return; /* it had been moved before */
    }
    free(job->place);
    free(job->place_fingerprint);
    job->place = strdup(place->name);
    job->place_fingerprint = strdup(place->fingerprint);
    if (group_begin(&s->group, &err) != SHEAR_OK ||
        store_set_disposal(s->store, job->id, place->name, place->fingerprint, &err) != SHEAR_OK) {
        log_warning("job %" PRId64 ": the place of its file could not be stored: %s", job->id,
                    err.message);
    }
}

void file_disposal_end(service *s, store_job *job) {
    char name[SPOOL_NAME_SIZE];
    spool_place place = {.name = ""};
    if (s->spool == NULL || !store_state_is_final(job->state) || !spooled_file_name(job, name))
        return;
    sheard_msg_side side = {.file = job->dropped,
                            .state = (enum sheard_job_state)job->state,
                            .code = job->state == STORE_DONE ? NULL : job->code,
                            .message = job->message,
                            .advice = job->advice,
                            .written_ms = clock_wall_ms(),
                            .version = SHEAR_VERSION_STRING};
    job_to_message(s, job, &side.job);
    free((char *)side.job.file_now); /* the file will be beside this report */
    side.job.file_now = NULL;
    move(s, name, job->state == STORE_DONE, &side, &place);
    job_message_deinit(&side.job);
    keep_place(s, job, &place);
}

void file_disposal_reject(service *s, const spool_file *file, const sheard_rpc_error *why) {
    const sheard_msg_side side = {.file = file->name,
                                  .state = SHEARD_JOB_FAILED,
                                  .code = why->name,
                                  .message = why->message,
                                  .advice = why->advice,
                                  .written_ms = clock_wall_ms(),
                                  .version = SHEAR_VERSION_STRING,
                                  .job = {.state = SHEARD_JOB_FAILED,
                                          .code = why->name,
                                          .message = why->message,
                                          .advice = why->advice,
                                          .source = {.path = file->name}}};
    spool_place ignored;
    log_notice("%s is no job: %s", file->name, why->message);
    move(s, file->active_name, false, &side, &ignored);
}
