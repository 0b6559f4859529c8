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
#include "service/core/permissions.h"
#include "service/core/problem_notes.h"
#include "service/core/statistics.h"
#include "service/core/user_names.h"
#include "spool/spool.h"
#include "store/store.h"

/* Calls of rooms into those above them; set once, before the loop runs. */
typedef struct service_hooks {
    size_t (*running_jobs)(const service *s);
    void (*stop_jobs)(service *s); /* stop and requeue the running jobs */
    void (*close)(service *s);     /* before the server closes: publish what is pending */
    /* Return SHEAR_OK if `fresh` may replace the present configuration. */
    int (*check_reload)(service *s, const sheard_config *fresh, shear_error *err);
    /* Those of jobs are called when the change is on disk. Move the file of a final job, if it has
     * one, to done/ or failed/, and store its place in *job. */
    void (*dispose_file)(service *s, store_job *job);
    /* The job is final and its file has been moved: answer the clients that wait for it. */
    void (*job_ended)(service *s, const store_job *job);
    /* The job now counts in its field. */
    void (*job_counted)(service *s, const store_job *job);
    /* The engine has an event of a job that is not in the store. */
    void (*other_event)(service *s, const engine_event *e);
} service_hooks;

enum { LOOP_SIGNALS = 3 };

/* Events of the loop (service/loop.h). */
typedef struct loop_events {
    uv_async_t engine; /* uv_async_send may be called from any thread */
    uv_signal_t signals[LOOP_SIGNALS];
    uv_timer_t tick;
} loop_events;

struct service {
    uv_loop_t loop;
    sheard_config config;
    const char *config_path;        /* NULL: the default one */
    const sheard_list *assignments; /* from the command line, for reloads */
    char user[64];                  /* name of the user that this process runs as */
    bool activated; /* systemd owns the socket: the next client starts the service again */
    int64_t started_wall_ms, started_steady_ms;

    notify notify;
    store *store;
    char database[4200]; /* path of the store */
    engine *engine;
    server *server; /* NULL: closed */
    spool *spool;   /* NULL: there is no watch folder */

    const service_hooks *hooks;
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
