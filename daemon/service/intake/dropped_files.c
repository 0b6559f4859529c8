/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/intake/dropped_files.h"

#include "base/cleanup.h"
#include "base/io.h"
#include "base/text.h"
#include "log/log.h"
#include "service/core/parts.h"
#include "service/core/tuning.h"
#include "service/intake/file_disposal.h"
#include "service/intake/submission.h"
#include "service/jobs/job_message.h"
#include "service/jobs/job_source.h"
#include "service/jobs/rpc_errors.h"
#include "service/jobs/spooled_file.h"

/* ---- a file and its job ---- */

typedef struct submitted_file {
    post_commit post; /* first */
    char active_name[SPOOL_NAME_SIZE];
} submitted_file;

/* The job of a file is on disk, or the commit failed. If the job has ended already (a restart
 * between commit and move), move its file now. */
static void submitted(post_commit *post, int code, const shear_error *err) {
    service *s = post->context;
    const submitted_file *file = (const submitted_file *)post;
    CLEANUP(store_job_deinit) store_job job = {0};
    shear_error ignored;
    if (code != SHEAR_OK) {
        file_disposal_put_off(s, file->active_name, store_code_name(code), err->message);
        return;
    }
    if (store_job_get(s->store, post->job, &job, &ignored) != SHEAR_OK)
        return;
    file_disposal_end(s, &job);
    if (!store_state_is_final(job.state))
        job_message_publish(s, &job);
}

/* Register what follows when the file's job is on disk. */
static void follow(service *s, const spool_file *file, int64_t id) {
    submitted_file *later = group_then(&s->group, submitted, id, sizeof *later);
    if (later == NULL) {
        log_error("out of memory: %s waits in active/ for the next start", file->active_name);
        return;
    }
    text_set(later->active_name, sizeof later->active_name, file->active_name);
}

static submission submission_of(const spool_file *file) {
    return (submission){.origin = STORE_SPOOL, .key = file->key, .dropped = file->name};
}

static void submit(service *s, const spool_file *file, const submission *sub) {
    sheard_rpc_error error;
    int64_t id = 0;
    bool known = false;
    if (submission_store(s, sub, &id, &known, &error) == SHEARD_RPC_OK) {
        follow(s, file, id);
    } else if (error.retry) {
        file_disposal_put_off(s, file->active_name, error.name, error.message);
    } else {
        file_disposal_reject(s, file, &error);
    }
}

/* A file that was reported before is probably a job already. Find it by its key, without reading
 * the file: the defaults, or the files that a job file names, may have changed. */
static bool is_known(service *s, const spool_file *file) {
    shear_error err = {0};
    int64_t id = 0;
    if (!file->again)
        return false;
    if (group_begin(&s->group, &err) != SHEAR_OK ||
        store_find_dropped(s->store, file->owner, file->key, file->name, &id, &err) != SHEAR_OK) {
        file_disposal_put_off(s, file->active_name, store_code_name(err.code), err.message);
        return true;
    }
    if (id != 0)
        follow(s, file, id);
    return id != 0;
}

/* ---- a job file ---- */

/* Read the job file, up to its largest size; *text is malloc'd. */
static int read_job_file(const service *s, const spool_file *file, char **text, size_t *n,
                         sheard_rpc_error *error) {
    CLEANUP(release_fd) int fd = -1;
    shear_error err = {0};
    *text = malloc(SHEARD_MSG_JOB_FILE_MAX + 1);
    if (*text == NULL)
        return sheard_rpc_fail(error, SHEARD_RPC_IO, NULL, "out of memory");
    if (spool_open_file(s->spool, file->active_name, &fd, &err) != SHEAR_OK)
        return sheard_rpc_fail(error, SHEARD_RPC_IO, NULL, "%s", err.message);
    const ssize_t got = io_read(fd, *text, SHEARD_MSG_JOB_FILE_MAX + 1);
    if (got > SHEARD_MSG_JOB_FILE_MAX) {
        return sheard_rpc_fail(error, SHEARD_RPC_LINE_TOO_LONG, "write a smaller job file",
                               "the job file is larger than %d bytes", SHEARD_MSG_JOB_FILE_MAX);
    }
    *n = got > 0 ? (size_t)got : 0;
    return SHEARD_RPC_OK;
}

/* Submit what the job file describes, with the rights of its owner. */
static void submit_job_file(service *s, const spool_file *file) {
    CLEANUP(release_free) char *text = NULL;
    CLEANUP(access_peer_deinit) access_peer peer = {0};
    CLEANUP(sheard_submit_deinit) sheard_msg_submit described = {0};
    sheard_rpc_error error = {0};
    shear_error err = {0};
    size_t n = 0;
    if (access_peer_from_user(file->owner, (gid_t)-1, &peer, &err) != SHEAR_OK) {
        file_disposal_put_off(s, file->active_name, shear_code_name(err.code), err.message);
        return;
    }
    if (read_job_file(s, file, &text, &n, &error) != SHEARD_RPC_OK ||
        sheard_job_file_parse(&described, text, n, &s->config.measure, &error) != SHEARD_RPC_OK) {
        file_disposal_reject(s, file, &error);
        return;
    }
    submission sub = submission_of(file);
    sub.peer = peer;
    sub.submit = &described;
    submit(s, file, &sub);
}

/* ---- a field ---- */

/* A file that cannot be opened becomes a job, which then fails with the reason. */
static bool is_too_large(const service *s, const spool_file *file, shear_error *err) {
    CLEANUP(release_fd) int fd = -1;
    shear_error ignored;
    return spool_open_file(s->spool, file->active_name, &fd, &ignored) == SHEAR_OK &&
           source_files_check_size(s, fd, file->name, err) != SHEAR_OK;
}

static void submit_field(service *s, const spool_file *file) {
    static const sheard_msg_submit plain = {0};
    char path[4400];
    shear_error err = {0};
    if (!file->again && is_too_large(s, file, &err)) {
        sheard_rpc_error error;
        rpc_error_from_access(&error, err.code, &err);
        file_disposal_reject(s, file, &error);
        return;
    }
    snprintf(path, sizeof path, "%s/active/%s", s->config.spool.directory, file->active_name);
    submission sub = submission_of(file);
    sub.submit = &plain;
    sub.peer.uid = file->owner;
    sub.source = path;
    submit(s, file, &sub);
}

/* ---- the watch folder's callbacks ---- */

static void on_found(void *context, const spool_file *file) {
    service *s = context;
    if (is_known(s, file))
        return;
    if (spooled_file_is_job_file(file->name)) {
        submit_job_file(s, file);
    } else {
        submit_field(s, file);
    }
}

static int64_t on_capacity(void *context) {
    const service *s = context;
    store_counts counts;
    shear_error ignored;
    if (s->life.state != SHEARD_SERVER_RUNNING || s->group.failing ||
        store_count(s->store, &counts, &ignored) != SHEAR_OK) {
        return 0;
    }
    const int64_t left = s->config.limits.queue - counts.unfinished;
    return left > 0 ? left : 0;
}

static void on_log(void *context, enum spool_level level, const char *text) {
    static void (*const write[])(const char *format, ...) = {
        [SPOOL_ERROR] = log_error, [SPOOL_WARNING] = log_warning, [SPOOL_NOTICE] = log_notice};
    (void)context;
    write[level]("%s", text);
}

static int64_t now_for_ages(void *context) {
    const service *s = context;
    return clock_watch_for_ages(&s->clock);
}

int dropped_files_open(service *s, shear_error *err) {
    const spool_tuning tuning = tuning_spool(&s->config);
    const spool_callbacks callbacks = {.capacity = on_capacity,
                                       .found = on_found,
                                       .log = on_log,
                                       .now_ms = now_for_ages,
                                       .context = s};
    return s->config.spool.enabled ? spool_open(&s->spool, &s->loop, s->config.spool.directory,
                                                &tuning, &callbacks, err)
                                   : SHEAR_OK;
}
