/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of the watch folder: taken as jobs with their key, ended when their jobs are. */
#include "service/inner.h"
#include "service/jobs/job_source.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

static bool ends_with(const char *text, const char *end) {
    const size_t n = strlen(text);
    const size_t m = strlen(end);
    return n >= m && strcasecmp(text + n - m, end) == 0;
}

/* It stays in active/, and is told again. */
static void put_off(service *s, const char *active_name, const char *code, const char *message) {
    shear_error ignored;
    problem_file_waits(s, active_name, code, message);
    spool_refuse(s->spool, active_name, &ignored);
}

static bool is_job_file(const char *name) {
    return ends_with(name, ".json");
}

/* How many names are looked at for a file whose place is not known: of many jobs, and of one. */
enum { GLANCE = 8, SEARCH = 256 };

bool spooled_name(const store_job *job, char name[SPOOL_NAME_SIZE]) {
    if (job->origin != STORE_SPOOL || job->key == NULL || job->dropped == NULL) {
        return false;
    }
    const int n = snprintf(name, SPOOL_NAME_SIZE, "%s-%s", job->key, job->dropped);
    return n > 0 && n < SPOOL_NAME_SIZE;
}

bool spooled_is_own(const store_job *job) {
    return job->origin == STORE_SPOOL && job->dropped != NULL && !is_job_file(job->dropped);
}

static spool_place place_of(const store_job *job) {
    spool_place place = {.name = ""};
    if (job->place != NULL) {
        snprintf(place.name, sizeof place.name, "%s", job->place);
        snprintf(place.fingerprint, sizeof place.fingerprint, "%s",
                 job->place_fingerprint != NULL ? job->place_fingerprint : "");
    }
    return place;
}

char *spooled_where(const service *s, const store_job *job) {
    char name[SPOOL_NAME_SIZE];
    char buffer[SPOOL_PLACE_SIZE];
    char *path = NULL;
    if (s->spool == NULL || !spooled_name(job, name)) {
        return NULL;
    }
    spool_place place = place_of(job);
    if (place.name[0] == '\0' && sheard_job_state_is_final(job->state)) {
        spool_find_place(s->spool, name, GLANCE, &place); /* the service died before it was kept */
    }
    const char *where = spool_locate(s->spool, name, &place, buffer);
    return where != NULL && asprintf(&path, "%s/%s", s->config.spool.directory, where) > 0 ? path
                                                                                           : NULL;
}

int spooled_take_back(service *s, const store_job *job, shear_error *err) {
    char name[SPOOL_NAME_SIZE];
    if (!spooled_name(job, name)) {
        return SHEAR_OK;
    }
    if (s->spool == NULL) {
        return shear_fail(err, SHEAR_E_IO, "switch the watch folder on again ([spool] enabled)",
                          "'%s' was dropped into the watch folder, which is switched off",
                          job->dropped);
    }
    spool_place place = place_of(job);
    if (place.name[0] == '\0') { /* of an older version's job, or the power failed */
        spool_find_place(s->spool, name, SEARCH, &place);
    }
    const int code = spool_restore(s->spool, name, &place, err);
    return is_job_file(job->dropped) ? SHEAR_OK : code;
}

/* The report beside the file, and the file to done/ or failed/. A report that cannot be written now
 * is tried again: the file stays in active/ and is told again. */
static void move(service *s, const char *active_name, bool good, const sheard_msg_side *side,
                 spool_place *place) {
    sheard_rpc_error error;
    shear_error err = {0};
    char *text = NULL;
    int code = sheard_side_text(&text, side, &error) == SHEARD_RPC_OK ? SHEAR_OK : SHEAR_E_NOMEM;
    if (code == SHEAR_OK) {
        /* Twice: the file may be there, and only an fsync missing; then it is not told again. */
        code = spool_dispose(s->spool, active_name, good, text, place, &err);
        if (code == SHEAR_E_IO) {
            spool_place again;
            code = spool_dispose(s->spool, active_name, good, text, &again, &err);
            *place = again.name[0] != '\0' ? again : *place;
        }
    }
    free(text);
    if (code != SHEAR_OK) {
        put_off(s, active_name, store_code_name(code), err.message);
    }
}

/* Where it lies is a help, not part of the job: that it could not be kept is no failure. */
static void keep_place(service *s, store_job *job, const spool_place *place) {
    shear_error err = {0};
    if (place->name[0] == '\0') {
        return; /* it had been moved before */
    }
    free(job->place);
    free(job->place_fingerprint);
    job->place = strdup(place->name);
    job->place_fingerprint = strdup(place->fingerprint);
    int code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_set_disposal(s->store, job->id, place->name, place->fingerprint, &err);
    }
    if (code != SHEAR_OK) {
        log_warning("job %lld: where its file lies is not kept: %s", (long long)job->id,
                    err.message);
    }
}

void spooled_end(service *s, store_job *job) {
    char name[SPOOL_NAME_SIZE];
    spool_place place = {.name = ""};
    if (s->spool == NULL || !sheard_job_state_is_final(job->state) || !spooled_name(job, name)) {
        return;
    }
    sheard_msg_side side = {.file = job->dropped,
                            .state = (enum sheard_job_state)job->state,
                            .code = job->state == STORE_DONE ? NULL : job->code,
                            .message = job->message,
                            .advice = job->advice,
                            .written_ms = wall_ms(),
                            .version = SHEARD_VERSION};
    present_job(s, job, &side.job);
    free((char *)side.job.file_now); /* beside this report, soon */
    side.job.file_now = NULL;
    move(s, name, job->state == STORE_DONE, &side, &place);
    present_job_free(&side.job);
    keep_place(s, job, &place);
}

/* A file that never becomes a job. */
static void reject(service *s, const spool_file *file, const sheard_rpc_error *why) {
    const sheard_msg_side side = {.file = file->name,
                                  .state = SHEARD_JOB_FAILED,
                                  .code = why->name,
                                  .message = why->message,
                                  .advice = why->advice,
                                  .written_ms = wall_ms(),
                                  .version = SHEARD_VERSION,
                                  .job = {.state = SHEARD_JOB_FAILED,
                                          .code = why->name,
                                          .message = why->message,
                                          .advice = why->advice,
                                          .source = {.path = file->name}}};
    spool_place ignored;
    log_notice("%s is no job: %s", file->name, why->message);
    move(s, file->active_name, false, &side, &ignored);
}

/* The job that a file stands for is on disk (or not): if it has ended already (a restart between
 * the commit and the move), the file follows now. */
static void submitted(service *s, after *a, int code, const shear_error *err) {
    shear_error ignored;
    if (code != SHEAR_OK) {
        put_off(s, a->name, store_code_name(code), err->message);
        return;
    }
    store_job job = {0};
    if (store_job_get(s->store, a->job, &job, &ignored) == SHEAR_OK) {
        spooled_end(s, &job);
        if (!sheard_job_state_is_final(job.state)) {
            publish_job(s, &job);
        }
    }
    store_job_deinit(&job);
}

/* This file is that job, once the group is on disk. */
static void follow(service *s, const spool_file *file, int64_t id) {
    after *a = group_after(s, submitted);
    if (a != NULL) {
        a->job = id;
        a->name = strdup(file->active_name);
    }
    if (a == NULL || a->name == NULL) {
        log_error("out of memory: %s waits in active/ for the next start", file->active_name);
    }
}

static void submit_file(service *s, const spool_file *file, const submission *sub) {
    sheard_rpc_error error;
    int64_t id = 0;
    bool known = false;
    if (submit_job(s, sub, &id, &known, &error) == SHEARD_RPC_OK) {
        follow(s, file, id);
    } else if (error.retry) {
        put_off(s, file->active_name, error.name, error.message);
    } else {
        reject(s, file, &error);
    }
}

/* A file that was told before is a job already, most likely. What it would become now (the
 * defaults, or the files that a job file names, may have changed) is not asked. */
static bool is_known(service *s, const spool_file *file) {
    shear_error err = {0};
    int64_t id = 0;
    int code = file->again ? group_begin(s, &err) : SHEAR_OK;
    if (code == SHEAR_OK && file->again) {
        code = store_find_dropped(s->store, file->owner, file->key, file->name, &id, &err);
    }
    if (code != SHEAR_OK) {
        put_off(s, file->active_name, store_code_name(code), err.message);
        return true;
    }
    if (id != 0) {
        follow(s, file, id);
    }
    return id != 0;
}

/* A job file: read whole, bounded, then as a submit of the file's owner. */
static void submit_job_file(service *s, const spool_file *file, submission *sub) {
    char *text = malloc(SHEARD_MSG_JOB_FILE_MAX + 1);
    shear_error err = {0};
    sheard_rpc_error error = {0};
    sheard_msg_submit submit = {0};
    int fd = -1;
    if (text == NULL || spool_open_file(s->spool, file->active_name, &fd, &err) != SHEAR_OK) {
        sheard_rpc_fail(&error, SHEARD_RPC_IO, NULL, "%s",
                        text == NULL ? "out of memory" : err.message);
        reject(s, file, &error);
        free(text);
        return;
    }
    size_t n = 0;
    ssize_t got = 1;
    while (got > 0 && n <= SHEARD_MSG_JOB_FILE_MAX) {
        got = read(fd, text + n, SHEARD_MSG_JOB_FILE_MAX + 1 - n);
        n += got > 0 ? (size_t)got : 0;
    }
    close(fd);
    if (n > SHEARD_MSG_JOB_FILE_MAX) {
        sheard_rpc_fail(&error, SHEARD_RPC_LINE_TOO_LONG, "write a smaller job file",
                        "the job file is larger than %d bytes", SHEARD_MSG_JOB_FILE_MAX);
    } else if (sheard_job_file_parse(&submit, text, n, &s->config.measure, &error) ==
               SHEARD_RPC_OK) {
        sub->submit = &submit;
        submit_file(s, file, sub);
        sub->submit = NULL;
        sheard_submit_deinit(&submit);
        free(text);
        return;
    }
    reject(s, file, &error);
    free(text);
}

/* A file that cannot be opened becomes a job, which tells why. */
static bool is_too_large(service *s, const spool_file *file, shear_error *err) {
    int fd = -1;
    shear_error ignored;
    if (spool_open_file(s->spool, file->active_name, &fd, &ignored) != SHEAR_OK) {
        return false;
    }
    const int code = source_check_size(s, fd, file->name, err);
    close(fd);
    return code != SHEAR_OK;
}

static void found(void *context, const spool_file *file) {
    service *s = context;
    char path[4400];
    static const sheard_msg_submit plain = {0};
    shear_error err = {0};
    submission sub = {
        .submit = &plain, .origin = STORE_SPOOL, .key = file->key, .dropped = file->name};
    if (is_known(s, file)) {
        return;
    }
    snprintf(path, sizeof path, "%s/active/%s", s->config.spool.directory, file->active_name);
    if (is_job_file(file->name)) {
        if (access_peer_from_user(file->owner, (gid_t)-1, &sub.peer, &err) == SHEAR_OK) {
            submit_job_file(s, file, &sub);
            access_peer_deinit(&sub.peer);
        } else {
            put_off(s, file->active_name, shear_code_name(err.code), err.message);
        }
        return;
    }
    if (!file->again && is_too_large(s, file, &err)) {
        sheard_rpc_error error;
        rpc_from_access(&error, err.code, &err);
        reject(s, file, &error);
        return;
    }
    sub.peer.uid = file->owner;
    sub.source = path;
    submit_file(s, file, &sub);
}

static int64_t room(void *context) {
    service *s = context;
    store_counts counts;
    shear_error ignored;
    if (s->state != SHEARD_SERVER_RUNNING || s->store_trouble_ms != 0 ||
        store_count(s->store, &counts, &ignored) != SHEAR_OK) {
        return 0;
    }
    const int64_t left = s->config.limits.queue - counts.unfinished;
    return left > 0 ? left : 0;
}

static void spool_log(void *context, int level, const char *text) {
    (void)context;
    if (level == SPOOL_ERROR) {
        log_error("%s", text);
    } else if (level == SPOOL_WARNING) {
        log_warning("%s", text);
    } else {
        log_notice("%s", text);
    }
}

static int64_t now_for_ages(void *context) {
    return clock_for_ages(context);
}

int spooled_open(service *s, shear_error *err) {
    const sheard_config *c = &s->config;
    const spool_tuning tuning = reload_spool_tuning(c);
    const spool_callbacks callbacks = {
        .capacity = room, .found = found, .log = spool_log, .now_ms = now_for_ages, .context = s};
    return c->spool.enabled
               ? spool_open(&s->spool, &s->loop, c->spool.directory, &tuning, &callbacks, err)
               : SHEAR_OK;
}
