/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the service says of itself. */
#include "service/core/descriptors.h"
#include "service/inner.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

sheard_msg_limits status_limits(const service *s) {
    const sheard_config *c = &s->config;
    return (sheard_msg_limits){.line_bytes = (int64_t)sheard_rpc_request_limits.line,
                               .depth = sheard_rpc_request_limits.depth,
                               .values = (int64_t)sheard_rpc_request_limits.values,
                               .list = SHEARD_MSG_LIST_MAX,
                               .jobs_page = SHEARD_MSG_JOBS_PAGE,
                               .fields_page = SHEARD_MSG_FIELDS_PAGE,
                               .connections = descriptors_connections(c),
                               .in_flight = c->limits.requests_in_flight,
                               .idle_s = c->limits.idle_timeout_ms / 1000,
                               .queue = c->limits.queue};
}

static int64_t free_bytes(const char *path) {
    struct statvfs v;
    return statvfs(path, &v) == 0 ? (int64_t)v.f_bavail * (int64_t)v.f_frsize : 0;
}

static int64_t file_size(const char *path) {
    struct stat st;
    return stat(path, &st) == 0 ? (int64_t)st.st_size : 0;
}

/* Over the last minute, or since the start where that is shorter. */
static sheard_msg_rates rates(const service *s) {
    const int64_t span = s->ticks < RATE_SLOTS - 1 ? s->ticks : RATE_SLOTS - 1;
    if (span <= 0) {
        return (sheard_msg_rates){0};
    }
    const int64_t now = s->ticks % RATE_SLOTS;
    const int64_t then = (s->ticks - span) % RATE_SLOTS;
    return (sheard_msg_rates){
        .stamps_per_s = (double)(s->stamps_at[now] - s->stamps_at[then]) / (double)span,
        .jobs_per_s = (double)(s->jobs_at[now] - s->jobs_at[then]) / (double)span};
}

static void fill_spool(const service *s, sheard_msg_spool *out) {
    if (s->spool != NULL) {
        const spool_stats st = spool_get_stats(s->spool);
        *out = (sheard_msg_spool){.path = s->config.spool.directory,
                                  .watching = st.watching,
                                  .incoming = st.waiting,
                                  .active = st.active,
                                  .done = st.done,
                                  .failed = st.failed,
                                  .ignored = st.ignored,
                                  .free_bytes = free_bytes(s->config.spool.directory)};
    }
}

enum { LEFT_LYING = 16 }; /* files that are told at most */

typedef struct left_lying {
    spool_ignored found[LEFT_LYING];
    sheard_msg_ignored told[LEFT_LYING];
} left_lying;

static void fill_left_lying(const service *s, left_lying *lying, sheard_msg_spool *out) {
    if (s->spool == NULL) {
        return;
    }
    out->n_left_lying = spool_get_ignored(s->spool, lying->found, LEFT_LYING);
    for (size_t i = 0; i < out->n_left_lying; i++) {
        lying->told[i] = (sheard_msg_ignored){lying->found[i].name, lying->found[i].reason};
    }
    out->left_lying = lying->told;
}

static int fill(service *s, sheard_msg_status *out, char *store_path, size_t size,
                shear_error *err) {
    store_counts counts;
    store_totals totals;
    server_statistics net;
    const engine_load load = engine_get_load(s->engine);
    int code = store_count(s->store, &counts, err);
    if (code == SHEAR_OK) {
        code = store_total(s->store, &totals, err);
    }
    if (code != SHEAR_OK) {
        return code;
    }
    server_get_statistics(s->server, &net);
    snprintf(store_path, size, "%s/sheard.db", s->config.daemon.state_dir);
    *out = (sheard_msg_status){
        .version = SHEARD_VERSION,
        .protocol = SHEARD_PROTOCOL_VERSION,
        .pid = getpid(),
        .state = s->state,
        .started_ms = s->started_ms,
        .uptime_s = 1e-3 * (double)(steady_ms() - s->started_steady_ms),
        .connections = (int64_t)net.connections,
        .subscribers = (int64_t)net.subscribers,
        .workers = {.total = load.workers, .busy = load.busy, .readers = load.jobs},
        .queue = {.length = counts.unfinished,
                  .capacity = s->config.limits.queue,
                  .blocks = load.blocks_left},
        .plans = {.kept = load.plans.count,
                  .bytes = load.plans.bytes,
                  .hits = load.plans.hits,
                  .misses = load.plans.misses},
        .memory = {.budget = load.memory_total,
                   .used = load.memory_used,
                   .waiting = load.memory_waiting},
        .states = {.queued = counts.jobs[STORE_QUEUED],
                   .running = counts.jobs[STORE_RUNNING],
                   .waiting = counts.jobs[STORE_WAITING],
                   .done = counts.jobs[STORE_DONE],
                   .failed = counts.jobs[STORE_FAILED],
                   .cancelled = counts.jobs[STORE_CANCELLED],
                   .retracted = counts.jobs[STORE_RETRACTED]},
        .totals = {.submitted = totals.submitted,
                   .counted = totals.counted,
                   .duplicates = totals.duplicates,
                   .failed = totals.failed,
                   .cancelled = totals.cancelled,
                   .stamps = totals.n_stamps,
                   .fields = totals.fields,
                   .retracted = totals.retracted},
        .rates = rates(s),
        .loop = pace_tell(s),
        .store = {.path = store_path,
                  .schema = store_opened(s->store)->version,
                  .bytes = file_size(store_path),
                  .free_bytes = free_bytes(s->config.daemon.state_dir),
                  .commits = s->commits},
        .config = s->config_path != NULL ? s->config_path : sheard_config_default_path(),
        .state_dir = s->config.daemon.state_dir,
        .catalogs = s->config.catalogs.enabled ? s->config.catalogs.directory : NULL,
        .user = s->user,
        .activated = s->activated,
        .limits = status_limits(s)};
    out->roots = roots_tell(s, &out->n_roots);
    const log_losses losses = log_get_losses();
    out->log = (sheard_msg_log){losses.lines, losses.waiting_bytes};
    fill_spool(s, &out->spool);
    return SHEAR_OK;
}

static void fill_problems(const problem_list *list, sheard_msg_status *out) {
    out->problems = list->lines;
    out->problem_details = list->items;
    out->n_problems = out->n_problem_details = list->n;
    out->disks = list->disks;
    out->n_disks = list->n_disks;
}

static void refuse(service *s, server_handle to, int code, const shear_error *err) {
    sheard_rpc_error error;
    rpc_from_store(&error, code, err);
    server_reply_error(s->server, to, &error);
}

void status_reply(service *s, server_handle to) {
    char path[4200];
    left_lying lying;
    sheard_reply reply = {0};
    shear_error err = {0};
    problem_list *list = problems_look(s, &err);
    if (list == NULL) {
        refuse(s, to, SHEAR_E_NOMEM, &err);
        return;
    }
    const int code = fill(s, &reply.status, path, sizeof path, &err);
    if (code != SHEAR_OK) {
        refuse(s, to, code, &err);
    } else {
        fill_problems(list, &reply.status);
        fill_left_lying(s, &lying, &reply.status.spool);
        server_reply(s->server, to, &reply);
    }
    free(list);
}

/* ---- Prometheus text ---- */

static void metric(FILE *out, const char *name, const char *type, const char *help, double value) {
    fprintf(out, "# HELP sheard_%s %s\n# TYPE sheard_%s %s\nsheard_%s %.17g\n", name, help, name,
            type, name, value);
}

static void write_metrics(const sheard_msg_status *st, const server_statistics *net, FILE *out) {
    static const char *const names[] = {"queued", "running",   "waiting",  "done",
                                        "failed", "cancelled", "retracted"};
    const int64_t states[] = {st->states.queued,   st->states.running, st->states.waiting,
                              st->states.done,     st->states.failed,  st->states.cancelled,
                              st->states.retracted};
    fprintf(out, "# HELP sheard_jobs Kept jobs by state.\n# TYPE sheard_jobs gauge\n");
    for (size_t i = 0; i < sizeof states / sizeof states[0]; i++) {
        fprintf(out, "sheard_jobs{state=\"%s\"} %" PRId64 "\n", names[i], states[i]);
    }
    metric(out, "uptime_seconds", "gauge", "Time since the start.", st->uptime_s);
    metric(out, "workers", "gauge", "Worker threads.", (double)st->workers.total);
    metric(out, "workers_busy", "gauge", "Worker threads at work.", (double)st->workers.busy);
    metric(out, "queue_capacity", "gauge", "Unfinished jobs that are taken at most.",
           (double)st->queue.capacity);
    metric(out, "blocks_left", "gauge", "Blocks of the running jobs that are not yet measured.",
           (double)st->queue.blocks);
    metric(out, "plans", "gauge", "Plans kept in memory.", (double)st->plans.kept);
    metric(out, "plans_bytes", "gauge", "Memory that they take.", (double)st->plans.bytes);
    metric(out, "memory_budget_bytes", "gauge", "Memory that jobs and plans may take together.",
           (double)st->memory.budget);
    metric(out, "memory_used_bytes", "gauge", "What they have reserved of it.",
           (double)st->memory.used);
    metric(out, "jobs_waiting_for_memory", "gauge", "Running jobs that wait for memory.",
           (double)st->memory.waiting);
    metric(out, "plan_hits_total", "counter", "Jobs that found their plan.",
           (double)st->plans.hits);
    metric(out, "plan_misses_total", "counter", "Jobs whose plan had to be made.",
           (double)st->plans.misses);
    metric(out, "jobs_submitted_total", "counter", "Jobs taken.", (double)st->totals.submitted);
    metric(out, "jobs_counted_total", "counter", "Jobs whose stamps count in a field.",
           (double)st->totals.counted);
    metric(out, "jobs_duplicate_total", "counter", "Jobs that were counted before.",
           (double)st->totals.duplicates);
    metric(out, "jobs_failed_total", "counter", "Jobs that failed for good.",
           (double)st->totals.failed);
    metric(out, "jobs_cancelled_total", "counter", "Jobs that were cancelled.",
           (double)st->totals.cancelled);
    metric(out, "contributions_retracted_total", "counter", "Contributions that were taken back.",
           (double)st->totals.retracted);
    metric(out, "stamps_total", "counter", "Stamps in counted jobs.", (double)st->totals.stamps);
    metric(out, "fields", "gauge", "Fields, each set of settings by itself.",
           (double)st->totals.fields);
    metric(out, "stamps_per_second", "gauge", "Stamps measured, mean of the last minute.",
           st->rates.stamps_per_s);
    metric(out, "loop_longest_seconds", "gauge",
           "Longest turn of the loop in the last minute, processor time.",
           1e-3 * st->loop.longest_minute_ms);
    metric(out, "unsent_bytes", "gauge", "Memory of replies and notifications that are not read.",
           (double)st->loop.unsent_bytes);
    metric(out, "clients_dropped_total", "counter", "Clients dropped because they did not read.",
           (double)st->loop.dropped);
    metric(out, "connections", "gauge", "Clients connected.", (double)net->connections);
    metric(out, "connections_accepted_total", "counter", "Clients since the start.",
           (double)net->accepted);
    metric(out, "bytes_in_total", "counter", "Bytes from clients.", (double)net->bytes_in);
    metric(out, "bytes_out_total", "counter", "Bytes to clients.", (double)net->bytes_out);
    metric(out, "store_commits_total", "counter", "Commits since the start.",
           (double)st->store.commits);
    metric(out, "store_bytes", "gauge", "Size of the database.", (double)st->store.bytes);
    metric(out, "store_free_bytes", "gauge", "Free space beside it.", (double)st->store.free_bytes);
    metric(out, "log_lines_lost_total", "counter", "Lines of the log that nobody read in time.",
           (double)st->log.lost);
    metric(out, "incoming_ignored", "gauge", "Files that are left lying in incoming/.",
           (double)st->spool.ignored);
}

static void begin(FILE *out, const char *name, const char *help) {
    fprintf(out, "# HELP sheard_%s %s\n# TYPE sheard_%s gauge\n", name, help, name);
}

/* Codes and uses are names of ours: nothing in them has to be escaped. */
static void write_problem_metrics(const problem_list *list, FILE *out) {
    metric(out, "problems", "gauge", "What an operator should look at.", (double)list->n);
    begin(out, "waiting_jobs", "Jobs that wait for their next attempt, by reason.");
    for (size_t i = 0; i < list->n_waiting; i++) {
        fprintf(out, "sheard_waiting_jobs{reason=\"%s\"} %" PRId64 "\n", list->waiting[i].code,
                list->waiting[i].jobs);
    }
    begin(out, "waiting_jobs_attempts", "Attempts of the waiting job with the most.");
    for (size_t i = 0; i < list->n_waiting; i++) {
        fprintf(out, "sheard_waiting_jobs_attempts{reason=\"%s\"} %" PRId64 "\n",
                list->waiting[i].code, list->waiting[i].attempts);
    }
    begin(out, "next_attempt_seconds", "When the first of them is tried again, since 1970.");
    for (size_t i = 0; i < list->n_waiting; i++) {
        fprintf(out, "sheard_next_attempt_seconds{reason=\"%s\"} %.3f\n", list->waiting[i].code,
                1e-3 * (double)list->waiting[i].next_ms);
    }
    begin(out, "disk_free_bytes", "Free space where the service writes.");
    for (size_t i = 0; i < list->n_disks; i++) {
        fprintf(out, "sheard_disk_free_bytes{use=\"%s\"} %" PRId64 "\n", list->disks[i].use,
                list->disks[i].free_bytes);
    }
    begin(out, "disk_usable", "Whether the service can write there.");
    for (size_t i = 0; i < list->n_disks; i++) {
        fprintf(out, "sheard_disk_usable{use=\"%s\"} %d\n", list->disks[i].use,
                list->disks[i].problem == NULL);
    }
}

static int metrics_text(service *s, const problem_list *list, char **text, shear_error *err) {
    char path[4200];
    size_t size = 0;
    sheard_msg_status st;
    server_statistics net;
    const int code = fill(s, &st, path, sizeof path, err);
    FILE *out = code == SHEAR_OK ? open_memstream(text, &size) : NULL;
    if (out != NULL) {
        server_get_statistics(s->server, &net);
        write_metrics(&st, &net, out);
        write_problem_metrics(list, out);
        if (fclose(out) == 0) {
            return SHEAR_OK;
        }
    }
    return code != SHEAR_OK ? code
                            : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the metrics");
}

void metrics_reply(service *s, server_handle to) {
    char *text = NULL;
    shear_error err = {0};
    problem_list *list = problems_look(s, &err);
    const int code = list != NULL ? metrics_text(s, list, &text, &err) : SHEAR_E_NOMEM;
    if (code != SHEAR_OK) {
        refuse(s, to, code, &err);
    } else {
        const sheard_reply reply = {
            .metrics = {.content_type = "text/plain; version=0.0.4; charset=utf-8", .text = text}};
        server_reply(s->server, to, &reply);
    }
    free(list);
    free(text);
}

/* Once a second: rates, and progress to those who asked for it. */
void status_tick(service *s) {
    s->ticks++;
    pace_tick(s);
    s->stamps_at[s->ticks % RATE_SLOTS] = engine_get_load(s->engine).stamps_total;
    s->jobs_at[s->ticks % RATE_SLOTS] = s->jobs_ended;
    for (const active_job *j = s->active; j != NULL; j = j->next) {
        sheard_notice_params params = {
            .job_progress = {
                .id = j->id,
                .progress = {
                    .total = -1, .rate = NAN, .eta_s = NAN, .bytes_done = -1, .bytes_total = -1}}};
        if (server_is_watched(s->server, SHEARD_NOTICE_JOB_PROGRESS, j->id, j->field) &&
            present_running(s, j->id, &params.job_progress.progress)) {
            server_publish(s->server, SHEARD_NOTICE_JOB_PROGRESS, j->id, j->field, &params);
        }
    }
}
