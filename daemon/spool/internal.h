/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/internal.h: what a spool is made of. */
#ifndef SHEARD_SPOOL_INTERNAL_H
#define SHEARD_SPOOL_INTERNAL_H

#include "spool/candidates.h"
#include "spool/folders.h"
#include "spool/names.h"
#include "spool/retention.h"
#include "spool/spool.h"
#include "spool/unacknowledged.h"
#include "spool/watch.h"

/* A look at all of incoming/, over several iterations of the loop. */
typedef struct scan {
    DIR *dir; /* NULL: none under way */
    uint64_t generation;
    int64_t next_ms;
} scan;

struct spool {
    uv_loop_t *loop;
    uv_poll_t poll;
    uv_timer_t timer;
    int handles;           /* of libuv, that are not closed yet */
    bool polling, started; /* the handles are open: poll, timer */
    bool closed;
    bool away; /* the directory was gone or replaced at the last scan */
    spool_callbacks call;
    spool_tuning tuning;
    folders folders;
    watch watch;
    candidates candidates;
    scan scan;
    int acquire_error; /* the last one told; 0 after a success */
    char trouble[256]; /* report.h; "": nothing */
    int64_t trouble_since_ms;
    unacknowledged unacknowledged;
    retention retention;
    uint64_t counter; /* of the names given */
    spool_stats stats;
};

/* What is done in one iteration of the loop is at most so much, so that the sockets are served
 * meanwhile. */
enum { SPOOL_STEP_NAMES = 512, SPOOL_STEP_FILES = 64 };

#endif
