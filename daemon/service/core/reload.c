/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The configuration anew, while the service runs. */
#include "engine/machine.h"
#include "service/core/descriptors.h"
#include "service/inner.h"

#include <stdlib.h>
#include <string.h>

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

server_limits reload_server_limits(const sheard_config *c) {
    server_limits limits;
    server_limits_init(&limits);
    limits.connections = (size_t)descriptors_connections(c);
    limits.user_connections = (size_t)c->limits.user_connections;
    limits.reserved_connections = (size_t)c->limits.admin_connections;
    limits.unsent_bytes = (size_t)c->limits.unsent_bytes;
    limits.in_flight = (size_t)c->limits.requests_in_flight;
    limits.idle_timeout_ms = c->limits.idle_timeout_ms;
    return limits;
}

int64_t reload_memory(const sheard_config *c) {
    const int64_t machine = machine_memory();
    if (c->limits.memory_bytes > machine) {
        log_warning("[limits] memory is %lld bytes, but this service can have no more than %lld",
                    (long long)c->limits.memory_bytes, (long long)machine);
    }
    return c->limits.memory_bytes > 0 ? c->limits.memory_bytes : machine / 4;
}

reader_limits reload_reader_limits(const sheard_config *c) {
    return (reader_limits){.memory_bytes = c->reader.memory_bytes,
                           .cpu_seconds = (c->reader.cpu_time_ms + 999) / 1000,
                           .unpacked_bytes = c->reader.unpacked_bytes,
                           .scratch_bytes = c->reader.scratch_bytes,
                           .shared_bytes = c->reader.shared_memory_bytes,
                           .timeout_ms = (int)c->reader.wall_time_ms};
}

spool_tuning reload_spool_tuning(const sheard_config *c) {
    return (spool_tuning){
        .settle_ms = c->spool.settle_time_ms,
        .scan_ms = c->spool.scan_interval_ms,
        .done = {c->spool.done.max_age_ms, c->spool.done.max_count, c->spool.done.max_bytes},
        .failed = {c->spool.failed.max_age_ms, c->spool.failed.max_count,
                   c->spool.failed.max_bytes}};
}

static void apply(service *s) {
    const sheard_config *c = &s->config;
    descriptors_raise(c);
    const server_limits limits = reload_server_limits(c);
    server_set_limits(s->server, &limits);
    server_set_defaults(s->server, &c->measure);
    const reader_limits readers = reload_reader_limits(c);
    engine_limit_readers(s->engine, &readers);
    engine_limit_memory(s->engine, reload_memory(c));
    engine_limit_plans(s->engine, c->plans.max_count, c->plans.max_bytes);
    log_set_level(c->daemon.log_level);
    if (s->spool != NULL) {
        const spool_tuning tuning = reload_spool_tuning(c);
        spool_tune(s->spool, &tuning);
    }
}

int reload_access(const sheard_config *c, access_list **admins, access_list **submitters,
                  access_roots **roots, shear_error *err) {
    int code = access_list_new(admins, c->access.admin_users.items, c->access.admin_users.n,
                               c->access.admin_groups.items, c->access.admin_groups.n, err);
    if (code == SHEAR_OK) {
        code = access_list_new(submitters, NULL, 0, c->access.submit_groups.items,
                               c->access.submit_groups.n, err);
    }
    if (code == SHEAR_OK) {
        code = access_roots_new(roots, c->access.data_roots.items, c->access.data_roots.n, err);
    }
    if (code != SHEAR_OK) {
        access_list_free(*admins);
        access_list_free(*submitters);
        *admins = *submitters = NULL;
    }
    return code;
}

int reload_hurried(const sheard_config *c, access_list **hurried, shear_error *err) {
    return access_list_new(hurried, c->access.priority_users.items, c->access.priority_users.n,
                           c->access.priority_groups.items, c->access.priority_groups.n, err);
}

/* Names that nobody has: into list[room], where that is not NULL; returns how many. */
static size_t unknown_names(const service *s, const char **list, size_t room) {
    const access_list *const lists[] = {s->admins, s->submitters, s->hurried};
    size_t n = 0;
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) {
        const char *text = NULL;
        for (size_t i = 0; n < room && (text = access_list_unknown(lists[k], i)) != NULL; i++) {
            if (list != NULL) {
                list[n] = text;
            }
            n++;
        }
    }
    return n;
}

/* What is as it was asked for, and will not work now. */
static const char **warnings_of(const service *s, size_t *n) {
    const size_t room = s->config.access.data_roots.n + unknown_names(s, NULL, SIZE_MAX);
    const char **list = calloc(room + 1, sizeof *list);
    *n = list != NULL ? roots_problems(s, list, room) : 0;
    *n += list != NULL ? unknown_names(s, list + *n, room - *n) : 0;
    return list;
}

void reload_warn_names(const service *s) {
    const char *texts[64];
    const size_t n = unknown_names(s, texts, sizeof texts / sizeof *texts);
    for (size_t i = 0; i < n; i++) {
        log_warning("%s", texts[i]);
    }
}

void reload_reply_deinit(sheard_msg_reloaded *reply) {
    free((void *)reply->changed);
    free((void *)reply->restart);
    free((void *)reply->warnings);
    *reply = (sheard_msg_reloaded){0};
}

/* Catalogs that go elsewhere from now on: is it a place for them? */
static int claim_catalogs(service *s, const sheard_config *fresh, shear_error *err) {
    const bool same = s->config.catalogs.enabled &&
                      strcmp(s->config.catalogs.directory, fresh->catalogs.directory) == 0;
    return fresh->catalogs.enabled && !same ? catalogs_claim(s, fresh->catalogs.directory, err)
                                            : SHEAR_OK;
}

int reload_config(service *s, sheard_msg_reloaded *reply, sheard_rpc_error *error) {
    enum { ROOM = 128 };
    static sheard_problems problems; /* large; one thread */
    size_t changed[ROOM];
    size_t restart[ROOM];
    sheard_config fresh;
    shear_error err = {0};
    access_list *admins = NULL;
    access_list *submitters = NULL;
    access_list *hurried = NULL;
    access_roots *roots = NULL;
    problems = (sheard_problems){0};
    *reply = (sheard_msg_reloaded){0};
    notify_reloading(&s->notify, NULL);
    int code = sheard_config_read(&fresh, s->config_path, &s->assignments, &problems);
    if (code != SHEAR_OK) {
        sheard_problems_error(&problems, &err);
    } else {
        code = reload_access(&fresh, &admins, &submitters, &roots, &err);
        code = code == SHEAR_OK ? reload_hurried(&fresh, &hurried, &err) : code;
        code = code == SHEAR_OK ? claim_catalogs(s, &fresh, &err) : code;
        if (code == SHEAR_OK) {
            const size_t all = sheard_config_changes(&s->config, &fresh, false, changed, ROOM);
            reply->n_restart = sheard_config_changes(&s->config, &fresh, true, restart, ROOM);
            reply->n_changed = all < ROOM ? all : ROOM;
            code = sheard_config_reload(&s->config, &fresh, &problems);
            if (code != SHEAR_OK) {
                sheard_problems_error(&problems, &err);
            }
        }
        sheard_config_deinit(&fresh);
    }
    if (code != SHEAR_OK) {
        access_list_free(admins);
        access_list_free(submitters);
        access_list_free(hurried);
        access_roots_free(roots);
        *reply = (sheard_msg_reloaded){0};
        log_error("the configuration was not reloaded, the old one stays: %s", err.message);
        notify_ready(&s->notify, NULL, NULL);
        return sheard_rpc_fail(error, SHEARD_RPC_BAD_CONFIG,
                               err.advice[0] != '\0' ? err.advice : NULL, "%s", err.message);
    }
    if (roots_set(s, &err) != SHEAR_OK) {
        log_warning("%s", err.message);
    }
    access_list_free(s->admins);
    access_list_free(s->submitters);
    access_list_free(s->hurried);
    access_roots_free(s->roots);
    s->admins = admins;
    s->submitters = submitters;
    s->hurried = hurried;
    s->roots = roots;
    reload_warn_names(s);
    reply->changed = names_of(changed, reply->n_changed);
    reply->restart = names_of(restart, reply->n_restart);
    reply->warnings = warnings_of(s, &reply->n_warnings);
    apply(s);
    log_notice("configuration reloaded: %zu settings changed, %zu of them need a restart",
               reply->n_changed, reply->n_restart);
    notify_ready(&s->notify, NULL, NULL);
    return SHEARD_RPC_OK;
}
