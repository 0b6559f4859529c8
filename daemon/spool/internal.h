/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/internal.h: struct spool, the state of a watch folder. */
#pragma once

#include "spool/candidates.h"
#include "spool/folders.h"
#include "spool/names.h"
#include "spool/retention.h"
#include "spool/spool.h"
#include "spool/unacknowledged.h"
#include "spool/watch.h"

/* A scan of all of incoming/, over several iterations of the loop. */
typedef struct scan {
    DIR *dir; /* NULL: no scan is under way */
    uint64_t generation;
    int64_t next_ms;
} scan;

struct spool {
    uv_loop_t *loop;
    uv_poll_t poll;
    uv_timer_t timer;
    int handles;           /* number of libuv's handles that are not closed yet */
    bool polling, started; /* poll, timer: the handle is open */
    bool closed;
    bool away; /* the directory was missing or replaced at the last scan */
    spool_callbacks call;
    spool_tuning tuning;
    folders folders;
    watch watch;
    candidates candidates;
    scan scan;
    int acquire_error; /* errno of the last reported failure; 0 after a success */
    char trouble[256]; /* see report.h; "": none */
    int64_t trouble_since_ms;
    unacknowledged unacknowledged;
    retention retention;
    uint64_t counter; /* of the keys made */
    spool_stats stats;
};

/* Most names and files per iteration of the loop, so that sockets are served in between. */
enum { SPOOL_STEP_NAMES = 512, SPOOL_STEP_FILES = 64 };
