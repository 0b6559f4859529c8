/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a spool is made of, for the files of this room. */
#ifndef SHEARD_SPOOL_INNER_H
#define SHEARD_SPOOL_INNER_H

#include "spool/candidates.h"
#include "spool/folders.h"
#include "spool/names.h"
#include "spool/retention.h"
#include "spool/spool.h"
#include "spool/unacknowledged.h"
#include "spool/watch.h"

/* A look at all of incoming/, over several turns of the loop. */
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
    waiting waiting;
    scan scan;
    int take_error;    /* the last one told; 0 after a success */
    char trouble[256]; /* what keeps files from being taken; "": nothing */
    int64_t trouble_since_ms;
    offers offers;
    sweep sweep;
    uint64_t counter; /* of the names given */
    spool_stats stats;
};

/* Steps of one turn of the loop do at most so much, so that the sockets are served meanwhile. */
enum { SPOOL_STEP_NAMES = 512, SPOOL_STEP_FILES = 64 };

int64_t spool_clock_ms(void); /* monotonic */
void spool_log(const spool *s, int level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* incoming.c. "More": there is more to do at once. */
void incoming_event(spool *s, int event, const char *name);
bool incoming_begin_scan(spool *s);
bool incoming_scan(spool *s);
bool incoming_settle(spool *s);
bool incoming_take(spool *s);
int64_t incoming_next_ms(const spool *s); /* when incoming_settle has something to do */

/* offers.c: what the owner has to be told */
bool offers_tell(spool *s);

/* ending.c: undo what a crash left half done in active/ */
int ending_recover(const folders *f, shear_error *err);
/* The undo log: the file is under way between active/ and FOLDER/NAME. These return 0 or errno. */
int ending_note(const folders *f, const char *active_name, int folder, const char *name);
void ending_forget(const folders *f, const char *active_name);
int ending_sync(const folders *f, int folder); /* that folder and active/ */

/* returning.c: this file is there now */
void place_set(const folders *f, spool_place *place, int folder, const char *name);

/* sweep.c */
bool sweep_step(spool *s);

#endif
