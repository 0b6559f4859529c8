/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/data_roots.h: which data roots exist, as seen by the service. They are checked when
 * they are set, and every few seconds in libuv's thread pool, so that a file server that does not
 * answer blocks nobody. Jobs beneath a missing root wait; when it is there again, they are tried at
 * once. */
#pragma once

#include "service/core/group.h"
#include "service/core/lifecycle.h"
#include "sheard/config.h"
#include "sheard/messages.h"

/* Roots and the results of their last check. */
typedef struct root_list {
    sheard_list paths;
    sheard_msg_root *roots; /* [n], owned */
    char (*reasons)[160];   /* [n], owned: texts of those that are missing */
    size_t n;
} root_list;

typedef struct data_roots {
    uv_loop_t *loop;
    group *group;
    const lifecycle *life;
    int64_t ticks;
    root_list known;
    uv_work_t work;
    root_list looking; /* copy for the pool's thread; n > 0: a check is under way */
    bool stale;        /* the configuration has changed since that check began */
} data_roots;

void data_roots_init(data_roots *d, uv_loop_t *loop, group *g, const lifecycle *life);
void data_roots_deinit(data_roots *d);
/* Replace the roots by those of the configuration, check them, and log a warning for each missing
 * one. Waits for the file systems. SHEAR_E_NOMEM: nothing has changed. */
int data_roots_set(data_roots *d, const sheard_list *paths, shear_error *err);
void data_roots_tick(data_roots *d); /* once a second */
