/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/reload.h"

#include "base/cleanup.h"
#include "log/log.h"
#include "service/core/parts.h"
#include "service/core/tuning.h"

#include <stdlib.h>

static sheard_problems problems; /* static because it is large; used by the loop's thread only */

/* Return "section.key" of each index, in one block of memory, or NULL if out of memory. */
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

/* Return the reasons why accepted settings do not work now (missing data roots, unknown names).
 * NULL: out of memory. */
static const char **warnings_of(const service *s, size_t *n) {
    const root_list *known = &s->roots.known;
    size_t unknown = 0;
    while (permissions_unknown(&s->permissions, unknown) != NULL)
        unknown++;
    const char **list = calloc(known->n + unknown + 1, sizeof *list);
    *n = 0;
    if (list == NULL)
        return NULL;
    for (size_t i = 0; i < known->n; i++) {
        if (known->roots[i].missing)
            list[(*n)++] = known->roots[i].reason;
    }
    for (size_t i = 0; i < unknown; i++)
        list[(*n)++] = permissions_unknown(&s->permissions, i);
    return list;
}

void reload_warn_names(const service *s) {
    const char *text = NULL;
    for (size_t i = 0; (text = permissions_unknown(&s->permissions, i)) != NULL; i++)
        log_warning("%s", text);
}

void reload_reply_deinit(sheard_msg_reloaded *reply) {
    free((void *)reply->changed);
    free((void *)reply->restart);
    free((void *)reply->warnings);
    *reply = (sheard_msg_reloaded){0};
}

/* Pass the new settings to the rooms that keep copies of them. */
static void apply(service *s) {
    const sheard_config *c = &s->config;
    tuning_raise_descriptors(c);
    const server_limits limits = tuning_server(c);
    server_set_limits(s->server, &limits);
    server_set_defaults(s->server, &c->measure);
    const reader_limits readers = tuning_reader(c);
    engine_limit_readers(s->engine, &readers);
    engine_limit_memory(s->engine, tuning_memory(c));
    engine_limit_plans(s->engine, c->plans.max_count, c->plans.max_bytes);
    log_set_level((enum log_level)c->daemon.log_level);
    if (s->spool != NULL) {
        const spool_tuning tuning = tuning_spool(c);
        spool_tune(s->spool, &tuning);
    }
}

/* Move the settings that may change from *fresh into the configuration; list them in *reply. */
static int replace_config(service *s, sheard_config *fresh, sheard_msg_reloaded *reply,
                          shear_error *err) {
    enum { MOST = 128 };
    size_t changed[MOST];
    size_t restart[MOST];
    const size_t n_changed = sheard_config_changes(&s->config, fresh, false, changed, MOST);
    const size_t n_restart = sheard_config_changes(&s->config, fresh, true, restart, MOST);
    if (sheard_config_reload(&s->config, fresh, &problems) != SHEAR_OK)
        return sheard_problems_error(&problems, err);
    reply->n_changed = n_changed < MOST ? n_changed : MOST;
    reply->n_restart = n_restart < MOST ? n_restart : MOST;
    reply->changed = names_of(changed, reply->n_changed);
    reply->restart = names_of(restart, reply->n_restart);
    return SHEAR_OK;
}

/* Look up the permissions of the new configuration before it replaces the old one. */
static int replace_all(service *s, sheard_config *fresh, sheard_msg_reloaded *reply,
                       shear_error *err) {
    CLEANUP(permissions_deinit) permissions found = {0};
    TRY(permissions_init(&found, fresh, err));
    TRY(s->hooks->check_reload(s, fresh, err));
    TRY(replace_config(s, fresh, reply, err));
    const permissions old = s->permissions;
    s->permissions = found;
    found = old;
    return SHEAR_OK;
}

static int read_and_replace(service *s, sheard_msg_reloaded *reply, shear_error *err) {
    sheard_config fresh;
    problems = (sheard_problems){0};
    if (sheard_config_read(&fresh, s->config_path, s->assignments, &problems) != SHEAR_OK)
        return sheard_problems_error(&problems, err);
    const int code = replace_all(s, &fresh, reply, err);
    sheard_config_deinit(&fresh);
    return code;
}

int reload_config(service *s, sheard_msg_reloaded *reply, sheard_rpc_error *error) {
    shear_error err = {0};
    *reply = (sheard_msg_reloaded){0};
    notify_reloading(&s->notify, NULL);
    if (read_and_replace(s, reply, &err) != SHEAR_OK) {
        log_error("the configuration was not reloaded, the old one stays: %s", err.message);
        notify_ready(&s->notify, NULL, NULL);
        return sheard_rpc_fail(error, SHEARD_RPC_BAD_CONFIG,
                               err.advice[0] != '\0' ? err.advice : NULL, "%s", err.message);
    }
    if (data_roots_set(&s->roots, &s->config.access.data_roots, &err) != SHEAR_OK)
        log_warning("%s", err.message);
    reload_warn_names(s);
    reply->warnings = warnings_of(s, &reply->n_warnings);
    apply(s);
    log_notice("configuration reloaded: %zu settings changed, %zu of them need a restart",
               reply->n_changed, reply->n_restart);
    notify_ready(&s->notify, NULL, NULL);
    return SHEARD_RPC_OK;
}
