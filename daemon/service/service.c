/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How the service is put together, and taken apart. */
#include "reader/program.h"
#include "reader/scratch.h"
#include "service/core/descriptors.h"
#include "service/core/owner.h"
#include "service/core/processors.h"
#include "service/inner.h"

#include <errno.h>
#include <pwd.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { CHECKPOINT_MS = 5000 };

static void wake(void *context) {
    service *s = context;
    uv_async_send(&s->engine_wake);
}

static bool is_admin(void *context, const access_peer *peer) {
    return peer_is_admin(context, peer);
}

int make_directory(const char *path, mode_t mode, shear_error *err) {
    if (mkdir(path, mode) == 0 || errno == EEXIST) {
        return SHEAR_OK;
    }
    return shear_fail(err, SHEAR_E_IO, "create it, or set another directory",
                      "cannot make the directory '%s': %s", path, strerror(errno));
}

static int check_owner(const service *s, shear_error *err) {
    const size_t i = (size_t)sheard_setting_find("daemon", "state_dir");
    return owner_check(s->config.daemon.state_dir, sheard_setting_at(i).initial, "sheard", err);
}

static int open_store(service *s, shear_error *err) {
    char path[4200];
    const store_options options = {.busy_ms = 5000};
    int code = check_owner(s, err);
    if (code == SHEAR_OK) {
        code = make_directory(s->config.daemon.state_dir, 0750, err);
    }
    snprintf(path, sizeof path, "%s/sheard.db", s->config.daemon.state_dir);
    if (code == SHEAR_OK) {
        code = solutions_new(&s->solutions, err);
    }
    if (code == SHEAR_OK) {
        code = store_open(&s->store, path, &options, wall_ms(), err);
    }
    if (code == SHEAR_OK) {
        code = clock_start(s, err);
    }
    if (code == SHEAR_OK && store_opened(s->store)->requeued > 0) {
        log_notice("%lld jobs were interrupted and go on",
                   (long long)store_opened(s->store)->requeued);
    }
    if (code == SHEAR_OK) {
        code = catalogs_open(s, err);
    }
    if (code == SHEAR_OK) {
        catalogs_remove_retracted(s);
    }
    return code;
}

static int open_engine(service *s, shear_error *err) {
    const sheard_config *c = &s->config;
    char program[4200];
    char copies[4200];
    const bool chosen = strcmp(c->reader.scratch, "auto") != 0;
    int code = reader_find_program(program, sizeof program, err);
    if (code == SHEAR_OK) {
        code = scratch_find(copies, sizeof copies, chosen ? c->reader.scratch : "",
                            c->daemon.state_dir, err);
    }
    if (code != SHEAR_OK) {
        return code;
    }
    reader_limits limits = reload_reader_limits(c);
    limits.program = program;
    limits.scratch = copies;
    const engine_options options = {.workers = c->daemon.workers > 0 ? (int)c->daemon.workers
                                                                     : processors_count(),
                                    .limits = limits,
                                    .checkpoint_ms = CHECKPOINT_MS,
                                    .memory_bytes = reload_memory(c),
                                    .plans_count = c->plans.max_count,
                                    .plans_bytes = c->plans.max_bytes,
                                    .wake = wake,
                                    .context = s};
    return engine_new(&s->engine, &options, err);
}

static int open_server(service *s, shear_error *err) {
    const sheard_config *c = &s->config;
    int fds[8];
    descriptors_raise(c);
    server_options options = {
        .path = c->daemon.socket,
        .mode = c->daemon.socket_mode,
        .group = c->daemon.socket_group,
        .fds = fds,
        .limits = reload_server_limits(c),
        .defaults = &c->measure,
        .handlers = {.request = methods_request, .is_admin = is_admin, .context = s}};
    const int code = server_activation(fds, 8, &options.n_fds, err);
    s->activated = s->activated || options.n_fds > 0;
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

static void name_user(char *out, size_t size) {
    const struct passwd *entry = getpwuid(geteuid());
    if (entry != NULL) {
        snprintf(out, size, "%s", entry->pw_name);
    } else {
        snprintf(out, size, "%lu", (unsigned long)geteuid());
    }
}

int service_open(service **out, sheard_config *config, const char *config_path,
                 const sheard_list *assignments, shear_error *err) {
    service *s = calloc(1, sizeof *s);
    *out = NULL;
    if (s == NULL) {
        sheard_config_deinit(config);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    }
    s->config = *config;
    s->config_path = config_path != NULL ? strdup(config_path) : NULL;
    s->started_ms = wall_ms();
    s->started_steady_ms = steady_ms();
    s->notify.fd = -1;
    TAILQ_INIT(&s->waiters);
    TAILQ_INIT(&s->wait_users);
    TAILQ_INIT(&s->forgotten);
    int code = SHEAR_OK;
    for (size_t i = 0; i < assignments->n && code == SHEAR_OK; i++) {
        code = sheard_list_append(&s->assignments, assignments->items[i], err);
    }
    uv_loop_init(&s->loop);
    life_start(s);
    if (code == SHEAR_OK) {
        code = notify_init(&s->notify, err);
    }
    if (code == SHEAR_OK) {
        code = reload_access(&s->config, &s->admins, &s->submitters, &s->roots, err);
    }
    if (code == SHEAR_OK) {
        code = reload_hurried(&s->config, &s->hurried, err);
    }
    if (code == SHEAR_OK) {
        reload_warn_names(s);
        name_user(s->user, sizeof s->user);
        code = roots_set(s, err);
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
    char sockets[1024]; /* systemd's, it may be, and not the configuration's */
    server_sockets(s->server, sockets, sizeof sockets);
    log_notice("sheard %s ready: socket %s, watch folder %s", SHEARD_VERSION, sockets,
               s->spool != NULL ? s->config.spool.directory : "none");
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
    life_close(s, 0);
    uv_run(&s->loop, UV_RUN_DEFAULT);
    engine_free(s->engine);
    news_free(s);
    solutions_free(s->solutions);
    forget_free(s);
    store_close(s->store);
    access_list_free(s->admins);
    access_list_free(s->submitters);
    access_list_free(s->hurried);
    access_roots_free(s->roots);
    roots_free(s);
    probe_free(s);
    notify_deinit(&s->notify);
    uv_loop_close(&s->loop);
    sheard_list_deinit(&s->assignments);
    sheard_config_deinit(&s->config);
    free(s->config_path);
    free(s);
}
