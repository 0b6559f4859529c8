/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/status.h"

#include "base/cleanup.h"
#include "log/log.h"
#include "service/core/clock.h"
#include "service/core/parts.h"
#include "service/core/tuning.h"
#include "shear/version.h"

#include <stdlib.h>
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
                               .connections = tuning_connections(c),
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

static void fill_spool(service *s, status *st) {
    sheard_msg_spool *out = &st->message.spool;
    if (s->spool == NULL)
        return;
    const spool_stats stats = spool_get_stats(s->spool);
    *out = (sheard_msg_spool){.path = s->config.spool.directory,
                              .watching = stats.watching,
                              .incoming = stats.waiting,
                              .active = stats.active,
                              .done = stats.done,
                              .failed = stats.failed,
                              .ignored = stats.ignored,
                              .free_bytes = free_bytes(s->config.spool.directory),
                              .left_lying = st->left_lying};
    out->n_left_lying = spool_get_ignored(s->spool, st->ignored, STATUS_LEFT_LYING);
    for (size_t i = 0; i < out->n_left_lying; i++)
        st->left_lying[i] = (sheard_msg_ignored){st->ignored[i].name, st->ignored[i].reason};
}

static void fill_problems(status *st) {
    const problem_list *list = &st->problems;
    sheard_msg_status *out = &st->message;
    out->problems = list->lines;
    out->problem_details = list->items;
    out->n_problems = out->n_problem_details = list->n;
    out->disks = list->disks;
    out->n_disks = list->n_disks;
}

static void fill_server(const service *s, status *st) {
    sheard_msg_status *out = &st->message;
    server_get_statistics(s->server, &st->net);
    out->connections = (int64_t)st->net.connections;
    out->subscribers = (int64_t)st->net.subscribers;
    out->loop = (sheard_msg_loop){.longest_ms = 1e-6 * (double)s->statistics.longest_turn_ns,
                                  .longest_minute_ms =
                                      1e-6 * (double)statistics_longest_turn_ns(&s->statistics),
                                  .unsent_bytes = (int64_t)st->net.unsent_bytes,
                                  .dropped = (int64_t)st->net.dropped};
}

static void fill_engine(const service *s, sheard_msg_status *out) {
    const engine_load load = engine_get_load(s->engine);
    out->workers =
        (sheard_msg_workers){.total = load.workers, .busy = load.busy, .readers = load.jobs};
    out->queue.blocks = load.blocks_left;
    out->plans = (sheard_msg_plans){.kept = load.plans.count,
                                    .bytes = load.plans.bytes,
                                    .hits = load.plans.hits,
                                    .misses = load.plans.misses};
    out->memory = (sheard_msg_memory){
        .budget = load.memory_total, .used = load.memory_used, .waiting = load.memory_waiting};
}

static int fill_store(const service *s, sheard_msg_status *out, shear_error *err) {
    store_counts counts;
    store_totals totals;
    TRY(store_count(s->store, &counts, err));
    TRY(store_total(s->store, &totals, err));
    out->queue.length = counts.unfinished;
    out->states = (sheard_msg_states){.queued = counts.jobs[STORE_QUEUED],
                                      .running = counts.jobs[STORE_RUNNING],
                                      .waiting = counts.jobs[STORE_WAITING],
                                      .done = counts.jobs[STORE_DONE],
                                      .failed = counts.jobs[STORE_FAILED],
                                      .cancelled = counts.jobs[STORE_CANCELLED],
                                      .retracted = counts.jobs[STORE_RETRACTED]};
    out->totals = (sheard_msg_totals){.submitted = totals.submitted,
                                      .counted = totals.counted,
                                      .duplicates = totals.duplicates,
                                      .failed = totals.failed,
                                      .cancelled = totals.cancelled,
                                      .stamps = totals.n_stamps,
                                      .fields = totals.fields,
                                      .retracted = totals.retracted};
    out->store = (sheard_msg_store){.path = s->database,
                                    .schema = store_opened(s->store)->version,
                                    .bytes = file_size(s->database),
                                    .free_bytes = free_bytes(s->config.daemon.state_dir),
                                    .commits = s->group.commits};
    return SHEAR_OK;
}

static void fill_service(const service *s, status *st) {
    const sheard_config *c = &s->config;
    const log_losses losses = log_get_losses();
    st->message = (sheard_msg_status){
        .version = SHEAR_VERSION_STRING,
        .protocol = SHEARD_PROTOCOL_VERSION,
        .pid = getpid(),
        .state = s->life.state,
        .started_ms = s->started_wall_ms,
        .uptime_s = 1e-3 * (double)(clock_steady_ms() - s->started_steady_ms),
        .queue = {.capacity = c->limits.queue},
        .rates = statistics_rates(&s->statistics),
        .config = s->config_path != NULL ? s->config_path : sheard_config_default_path(),
        .state_dir = c->daemon.state_dir,
        .catalogs = c->catalogs.enabled ? c->catalogs.directory : NULL,
        .user = s->user,
        .activated = s->activated,
        .limits = status_limits(s),
        .roots = s->roots.known.roots,
        .n_roots = s->roots.known.n,
        .log = {losses.lines, losses.waiting_bytes}};
}

int status_new(status **out, service *s, shear_error *err) {
    status *st = calloc(1, sizeof *st);
    *out = st;
    if (st == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for what is to be told");
    problem_list_fill(&st->problems, s);
    fill_service(s, st);
    fill_server(s, st);
    fill_engine(s, &st->message);
    fill_problems(st);
    fill_spool(s, st);
    return fill_store(s, &st->message, err);
}
