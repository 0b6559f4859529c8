/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/parts.h: struct service: the modules of the service and the state that they share.
 * It belongs to the loop's thread.
 *
 * Modules of core are members; those of the rooms above are pointers to incomplete types, whose
 * headers are included where they are used. */
#pragma once

#include "engine/engine.h"
#include "notify/notify.h"
#include "server/server.h"
#include "service/core/clock_watch.h"
#include "service/core/data_roots.h"
#include "service/core/group.h"
#include "service/core/lifecycle.h"
#include "service/core/loop.h"
#include "service/core/permissions.h"
#include "service/core/problem_notes.h"
#include "service/core/statistics.h"
#include "service/core/user_names.h"
#include "spool/spool.h"
#include "store/store.h"

/* Calls from core into the rooms above it; set once, before the loop runs. */
typedef struct core_hooks {
    void (*tick)(service *s);          /* once a second */
    void (*engine_events)(service *s); /* the engine has events */
    size_t (*running_jobs)(const service *s);
    void (*stop_jobs)(service *s); /* stop and requeue the running jobs */
    void (*close)(service *s);     /* before the server closes: publish what is pending */
    /* Return SHEAR_OK if `fresh` may replace the present configuration. */
    int (*check_reload)(service *s, const sheard_config *fresh, shear_error *err);
} core_hooks;

struct service {
    uv_loop_t loop;
    sheard_config config;
    char *config_path;       /* NULL: the default one */
    sheard_list assignments; /* from the command line, for reloads */
    char user[64];           /* name of the user that this process runs as */
    bool activated;          /* systemd owns the socket: the next client starts the service again */
    int64_t started_wall_ms, started_steady_ms;

    notify notify;
    store *store;
    engine *engine;
    server *server; /* NULL: closed */
    spool *spool;   /* NULL: there is no watch folder */

    const core_hooks *hooks;
    loop_events events;
    lifecycle life;
    group group;
    clock_watch clock;
    permissions permissions;
    data_roots roots;
    problem_notes notes;
    user_names users;
    statistics statistics;

    struct active_jobs *jobs;         /* jobs/active_jobs.h */
    struct estimates *estimates;      /* fields/estimates.h */
    struct change_notifier *notifier; /* fields/change_notifier.h */
    struct field_purge *purge;        /* fields/field_purge.h */
    struct pending_waits *waits;      /* rpc/pending_waits.h */
    struct probe *probe;              /* rpc/probe.h */
};
