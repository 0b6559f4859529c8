/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From start to stop. */
#include "service/inner.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { FLUSH_MS = 2000, CHECKPOINT_MS = 5000 };

/* ---- stopping ---- */

static void close_handle(uv_handle_t *handle) {
    if (!uv_is_closing(handle)) {
        uv_close(handle, NULL);
    }
}

/* The server is gone: close what is left, so that the loop ends. */
static void server_closed(void *context) {
    service *s = context;
    s->server = NULL;
    close_handle((uv_handle_t *)&s->engine_wake);
    close_handle((uv_handle_t *)&s->commit_check);
    close_handle((uv_handle_t *)&s->commit_now);
    close_handle((uv_handle_t *)&s->tick);
    close_handle((uv_handle_t *)&s->drain_end);
    for (int i = 0; i < 3; i++) {
        close_handle((uv_handle_t *)&s->signals[i]);
    }
}

shear_msg_stopping life_left(service *s) {
    store_counts counts = {0};
    shear_error ignored;
    store_count(s->store, &counts, &ignored);
    return (shear_msg_stopping){.state = s->state,
                                .running = counts.jobs[STORE_RUNNING],
                                .queued = counts.jobs[STORE_QUEUED] + counts.jobs[STORE_WAITING]};
}

void life_announce(service *s) {
    const shear_notice_params params = {.server_state = life_left(s)};
    server_publish(s->server, SHEAR_NOTICE_SERVER_STATE, 0, NULL, &params);
}

void life_drain_queue(service *s) {
    if (s->state != SHEAR_SERVER_RUNNING) {
        return;
    }
    const shear_msg_stopping left = life_left(s);
    s->state = SHEAR_SERVER_DRAINING;
    s->drain_pending = left.running + left.queued > 0;
    log_notice("draining: %lld jobs are left", (long long)(left.running + left.queued));
}

/* The last job of a drain has ended: tell it, once. */
static void check_drain(service *s) {
    if (s->state != SHEAR_SERVER_DRAINING || !s->drain_pending) {
        return;
    }
    const shear_msg_stopping left = life_left(s);
    if (left.running + left.queued == 0 && s->first_after == NULL && !s->group_open) {
        s->drain_pending = false;
        log_notice("drained: no job is left");
        life_announce(s);
    }
}

void life_check(service *s) {
    check_drain(s);
    if (s->state != SHEAR_SERVER_STOPPING || s->n_active > 0 || s->first_after != NULL ||
        s->group_open || s->closing || s->server == NULL) {
        return;
    }
    s->closing = true;
    news_publish(s);
    spool_close(s->spool);
    s->spool = NULL;
    server_close(s->server, FLUSH_MS, server_closed, s);
}

/* Give the running jobs back: their checkpoints are kept, and they go on at the next start. */
void life_stop_now(service *s) {
    s->state = SHEAR_SERVER_STOPPING;
    server_stop_accepting(s->server);
    life_announce(s);
    jobs_stop_all(s);
}

static void drain_over(uv_timer_t *timer) {
    service *s = timer->data;
    if (s->n_active > 0) {
        log_notice("the time to drain is over: %d jobs go on at the next start", s->n_active);
    }
    jobs_stop_all(s);
}

/* Take no new jobs, finish the running ones in the time that is given, then stop. */
void life_drain(service *s, double timeout_s) {
    const double seconds =
        isnan(timeout_s) ? 1e-3 * (double)s->config.daemon.drain_timeout_ms : timeout_s;
    if (s->state == SHEAR_SERVER_STOPPING) {
        return;
    }
    log_notice("stopping: %d running jobs have %.0f s to finish", s->n_active, seconds);
    s->state = SHEAR_SERVER_STOPPING;
    notify_stopping(&s->notify, "finishing the running jobs", NULL);
    life_announce(s);
    uv_timer_start(&s->drain_end, drain_over, (uint64_t)(1e3 * fmax(0.0, seconds)), 0);
}

/* ---- reload ---- */

/* "section.key" of each, in one block of memory. */
static const char **names_of(const size_t *indices, size_t n) {
    enum { NAME_SIZE = 80 };
    const char **names = calloc(n + 1, sizeof *names + NAME_SIZE);
    char *text = (char *)(names + n + 1);
    for (size_t i = 0; names != NULL && i < n; i++, text += NAME_SIZE) {
        const sheard_setting setting = sheard_setting_at(indices[i]);
        snprintf(text, NAME_SIZE, "%s.%s", setting.section, setting.key);
        names[i] = text;
    }
    return names;
}

static void apply(service *s) {
    const sheard_config *c = &s->config;
    server_limits limits;
    server_limits_init(&limits);
    limits.connections = (size_t)c->limits.connections;
    limits.in_flight = (size_t)c->limits.requests_in_flight;
    limits.idle_timeout_ms = c->limits.idle_timeout_ms;
    server_set_limits(s->server, &limits);
    server_set_defaults(s->server, &c->measure);
    engine_limit_plans(s->engine, c->plans.max_count, c->plans.max_bytes);
    log_set_level(c->daemon.log_level);
    if (s->spool != NULL) {
        const spool_tuning tuning = {
            .settle_ms = c->spool.settle_time_ms,
            .scan_ms = c->spool.scan_interval_ms,
            .done = {c->spool.done.max_age_ms, c->spool.done.max_count, c->spool.done.max_bytes},
            .failed = {c->spool.failed.max_age_ms, c->spool.failed.max_count,
                       c->spool.failed.max_bytes}};
        spool_tune(s->spool, &tuning);
    }
}

/* Lists and roots anew; the old ones stay where the new ones cannot be had. */
static int open_access(const sheard_config *c, access_list **admins, access_list **submitters,
                       access_roots **roots, shear_error *err) {
    int code = access_list_new(admins, c->access.admin_users.items, c->access.admin_users.n,
                               c->access.admin_groups.items, c->access.admin_groups.n, err);
    if (code == SHEAR_OK) {
        code = access_list_new(submitters, NULL, 0, c->access.submit_groups.items,
                               c->access.submit_groups.n, err);
    }
    if (code == SHEAR_OK) {
        code = access_roots_open(roots, c->access.data_roots.items, c->access.data_roots.n, err);
    }
    if (code != SHEAR_OK) {
        access_list_free(*admins);
        access_list_free(*submitters);
        *admins = *submitters = NULL;
    }
    return code;
}

int life_reload(service *s, shear_msg_reloaded *reply, shear_rpc_error *error) {
    enum { ROOM = 128 };
    static sheard_problems problems; /* large; one thread */
    size_t changed[ROOM];
    size_t restart[ROOM];
    sheard_config fresh;
    shear_error err = {0};
    access_list *admins = NULL;
    access_list *submitters = NULL;
    access_roots *roots = NULL;
    problems = (sheard_problems){0};
    *reply = (shear_msg_reloaded){0};
    notify_reloading(&s->notify, NULL);
    int code = sheard_config_read(&fresh, s->config_path, &s->assignments, &problems);
    if (code != SHEAR_OK) {
        sheard_problems_error(&problems, &err);
    } else {
        code = open_access(&fresh, &admins, &submitters, &roots, &err);
        if (code == SHEAR_OK) {
            const size_t all = sheard_config_changes(&s->config, &fresh, false, changed, ROOM);
            reply->n_restart = sheard_config_changes(&s->config, &fresh, true, restart, ROOM);
            reply->n_changed = all < ROOM ? all : ROOM;
            code = sheard_config_reload(&s->config, &fresh, &problems);
            if (code != SHEAR_OK) {
                sheard_problems_error(&problems, &err);
            }
        }
        sheard_config_free(&fresh);
    }
    if (code != SHEAR_OK) {
        access_list_free(admins);
        access_list_free(submitters);
        access_roots_close(roots);
        *reply = (shear_msg_reloaded){0};
        log_error("the configuration was not reloaded, the old one stays: %s", err.message);
        notify_ready(&s->notify, NULL, NULL);
        return shear_rpc_fail(error, SHEAR_RPC_BAD_CONFIG,
                              err.advice[0] != '\0' ? err.advice : NULL, "%s", err.message);
    }
    access_list_free(s->admins);
    access_list_free(s->submitters);
    access_roots_close(s->roots);
    s->admins = admins;
    s->submitters = submitters;
    s->roots = roots;
    reply->changed = names_of(changed, reply->n_changed);
    reply->restart = names_of(restart, reply->n_restart);
    apply(s);
    log_notice("configuration reloaded: %zu settings changed, %zu of them need a restart",
               reply->n_changed, reply->n_restart);
    notify_ready(&s->notify, NULL, NULL);
    return SHEAR_RPC_OK;
}

/* ---- the loop's callbacks ---- */

static void on_signal(uv_signal_t *handle, int number) {
    service *s = handle->data;
    if (number == SIGHUP) {
        shear_msg_reloaded reply;
        shear_rpc_error error;
        life_reload(s, &reply, &error);
        free((void *)reply.changed);
        free((void *)reply.restart);
    } else if (s->state == SHEAR_SERVER_STOPPING) {
        log_notice("stopping at once: %d jobs go on at the next start", s->n_active);
        jobs_stop_all(s);
    } else {
        life_drain(s, NAN);
    }
}

static void on_engine(uv_async_t *async) {
    jobs_take_events(async->data);
}

/* Once a second. */
static void on_tick(uv_timer_t *timer) {
    service *s = timer->data;
    status_tick(s);
    waits_expire(s);
    news_publish(s);
    log_flush();
    if (s->notify.watchdog_ms > 0) {
        notify_watchdog(&s->notify, NULL);
    }
    /* After a failed commit the next try is due: an empty group tells whether the disk is well
     * again. */
    if (s->store_trouble_ms != 0) {
        shear_error ignored;
        group_begin(s, &ignored);
    }
    if (s->config.retention.jobs_max_age_ms > 0 || s->config.retention.jobs_max_count > 0) {
        shear_error err = {0};
        int64_t retired = 0;
        const sheard_config *c = &s->config;
        const store_retention rule = {
            .finished_before_ms = c->retention.jobs_max_age_ms > 0
                                      ? wall_ms() - c->retention.jobs_max_age_ms
                                      : INT64_MIN,
            .keep = c->retention.jobs_max_count > 0 ? c->retention.jobs_max_count : -1,
            .batch = 1000};
        store_retire(s->store, &rule, &retired, &err);
    }
    if (s->spool != NULL && s->ticks % 5 == 0) {
        spool_wake(s->spool);
    }
}

static void wake(void *context) {
    service *s = context;
    uv_async_send(&s->engine_wake);
}

static void on_closed(void *context, uint64_t connection) {
    waits_forget(context, connection);
}

/* ---- starting ---- */

static int make_directory(const char *path, mode_t mode, shear_error *err) {
    if (mkdir(path, mode) == 0 || errno == EEXIST) {
        return SHEAR_OK;
    }
    return shear_fail(err, SHEAR_E_IO, "create it, or set another directory",
                      "cannot make the directory '%s': %s", path, strerror(errno));
}

static int open_store(service *s, shear_error *err) {
    char path[4200];
    const store_options options = {.busy_ms = 5000};
    int code = make_directory(s->config.daemon.state_dir, 0750, err);
    if (code == SHEAR_OK && s->config.catalogues.enabled) {
        code = make_directory(s->config.catalogues.directory, 0750, err);
    }
    snprintf(path, sizeof path, "%s/sheard.db", s->config.daemon.state_dir);
    if (code == SHEAR_OK) {
        code = store_open(&s->store, path, &options, wall_ms(), err);
    }
    if (code == SHEAR_OK && store_opened(s->store)->requeued > 0) {
        log_notice("%lld jobs were interrupted and go on",
                   (long long)store_opened(s->store)->requeued);
    }
    if (code == SHEAR_OK) {
        catalogues_sweep(s);
    }
    return code;
}

/* sheard-reader: beside this program, or where it is installed. */
static void find_reader(char *out, size_t size) {
    char self[3800] = "";
    const ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
    char *slash = n > 0 ? strrchr(self, '/') : NULL;
    if (slash != NULL) {
        *slash = '\0';
        snprintf(out, size, "%s/sheard-reader", self);
        if (access(out, X_OK) == 0) {
            return;
        }
    }
    snprintf(out, size, "%s", SHEARD_READER_PATH);
}

static int open_engine(service *s, shear_error *err) {
    const sheard_config *c = &s->config;
    char program[4000];
    char scratch[4200];
    find_reader(program, sizeof program);
    snprintf(scratch, sizeof scratch, "%s/scratch", c->daemon.state_dir);
    const int code = make_directory(scratch, 0700, err);
    if (code != SHEAR_OK) {
        return code;
    }
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    const engine_options options = {.workers = c->daemon.workers > 0 ? (int)c->daemon.workers
                                                                     : (int)(cores > 0 ? cores : 1),
                                    .limits = {.program = program,
                                               .scratch = scratch,
                                               .memory_bytes = c->reader.memory_bytes,
                                               .cpu_seconds = (c->reader.cpu_time_ms + 999) / 1000,
                                               .unpacked_bytes = c->reader.max_file_bytes,
                                               .shared_bytes = c->reader.shared_memory_bytes,
                                               .timeout_ms = (int)c->reader.wall_time_ms},
                                    .checkpoint_ms = CHECKPOINT_MS,
                                    .plans_count = c->plans.max_count,
                                    .plans_bytes = c->plans.max_bytes,
                                    .wake = wake,
                                    .context = s};
    return engine_new(&s->engine, &options, err);
}

static int open_server(service *s, shear_error *err) {
    const sheard_config *c = &s->config;
    int fds[8];
    server_options options = {
        .path = c->daemon.socket,
        .mode = c->daemon.socket_mode,
        .group = c->daemon.socket_group,
        .fds = fds,
        .defaults = &c->measure,
        .handlers = {.request = methods_request, .closed = on_closed, .context = s}};
    server_limits_init(&options.limits);
    options.limits.connections = (size_t)c->limits.connections;
    options.limits.in_flight = (size_t)c->limits.requests_in_flight;
    options.limits.idle_timeout_ms = c->limits.idle_timeout_ms;
    const int code = server_activation(fds, 8, &options.n_fds, err);
    return code == SHEAR_OK ? server_open(&s->server, &s->loop, &options, err) : code;
}

/* A service that was killed while it started a reader may leave a child that holds its socket and
 * its locks until it has become the reader: a moment, but a restart comes as soon. */
static int open_when_left(service *s, int (*open_it)(service *, shear_error *), int taken,
                          shear_error *err) {
    enum { PATIENCE_MS = 2000, STEP_MS = 50 };
    const struct timespec step = {.tv_nsec = STEP_MS * 1000000L};
    int code = open_it(s, err);
    for (int waited = 0; code == taken && waited < PATIENCE_MS; waited += STEP_MS) {
        nanosleep(&step, NULL);
        code = open_it(s, err);
    }
    return code;
}

static void start_handles(service *s) {
    static const int numbers[3] = {SIGTERM, SIGINT, SIGHUP};
    uv_async_init(&s->loop, &s->engine_wake, on_engine);
    uv_timer_init(&s->loop, &s->tick);
    uv_timer_init(&s->loop, &s->drain_end);
    s->engine_wake.data = s->tick.data = s->drain_end.data = s;
    uv_timer_start(&s->tick, on_tick, 1000, 1000);
    for (int i = 0; i < 3; i++) {
        uv_signal_init(&s->loop, &s->signals[i]);
        s->signals[i].data = s;
        uv_signal_start(&s->signals[i], on_signal, numbers[i]);
    }
    group_start(s);
}

int service_open(service **out, sheard_config *config, const char *config_path,
                 const sheard_list *assignments, shear_error *err) {
    service *s = calloc(1, sizeof *s);
    *out = NULL;
    if (s == NULL) {
        sheard_config_free(config);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    }
    s->config = *config;
    s->config_path = config_path != NULL ? strdup(config_path) : NULL;
    s->started_ms = wall_ms();
    s->notify.fd = -1;
    int code = SHEAR_OK;
    for (size_t i = 0; i < assignments->n && code == SHEAR_OK; i++) {
        code = sheard_list_append(&s->assignments, assignments->items[i], err);
    }
    uv_loop_init(&s->loop);
    start_handles(s);
    if (code == SHEAR_OK) {
        code = notify_init(&s->notify, err);
    }
    if (code == SHEAR_OK) {
        code = open_access(&s->config, &s->admins, &s->submitters, &s->roots, err);
    }
    if (code == SHEAR_OK) {
        code = open_store(s, err);
    }
    if (code == SHEAR_OK) {
        code = open_engine(s, err);
    }
    if (code == SHEAR_OK) {
        code = open_when_left(s, open_server, SHEAR_E_EXISTS, err);
    }
    if (code == SHEAR_OK) {
        code = open_when_left(s, spooled_open, SPOOL_LOCKED, err);
    }
    if (code != SHEAR_OK) {
        service_close(s);
        return code;
    }
    *out = s;
    return SHEAR_OK;
}

int service_run(service *s) {
    log_notice("sheard %s ready: socket %s, watch folder %s", SHEARD_VERSION,
               s->config.daemon.socket, s->spool != NULL ? s->config.spool.directory : "none");
    notify_ready(&s->notify, "ready", NULL);
    jobs_fill(s);
    uv_run(&s->loop, UV_RUN_DEFAULT);
    log_notice("sheard stopped");
    return s->exit_code;
}

void service_close(service *s) {
    if (s == NULL) {
        return;
    }
    spool_close(s->spool);
    if (s->server != NULL) {
        server_close(s->server, 0, server_closed, s);
    } else {
        server_closed(s);
    }
    uv_run(&s->loop, UV_RUN_DEFAULT);
    engine_free(s->engine);
    waits_free(s);
    news_free(s);
    spooled_free(s);
    store_close(s->store);
    access_list_free(s->admins);
    access_list_free(s->submitters);
    access_roots_close(s->roots);
    notify_deinit(&s->notify);
    uv_loop_close(&s->loop);
    sheard_list_free(&s->assignments);
    sheard_config_free(&s->config);
    free(s->config_path);
    free(s);
}
