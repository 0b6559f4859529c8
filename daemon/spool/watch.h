/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/watch.h: watch incoming/ by inotify. */
#pragma once

enum watch_event {
    WATCH_COMPLETE, /* closed after writing, or renamed into place */
    WATCH_BEGUN,    /* a new name: created, or linked */
    WATCH_GONE,     /* removed, or renamed away */
    WATCH_OVERFLOW, /* events were lost */
    WATCH_LOST,     /* the directory was removed, renamed or unmounted */
    WATCH_NONE      /* no event: a scan found it */
};

typedef struct watch {
    int fd; /* -1: not open */
    int id; /* watch number of the directory; -1: not watching */
    int parent;
} watch;

/* Open inotify. Return 0, or errno with w->fd -1. */
int watch_init(watch *w);
void watch_deinit(watch *w);
/* Watch this directory, whose name in `parent` is incoming, in place of any other. Return 0 or
 * errno. */
int watch_start(watch *w, int directory, int parent);
/* Call `handle` for each event, in order; the name is NULL for overflow and loss. Return 0 or
 * errno. */
int watch_read(watch *w, void (*handle)(void *context, enum watch_event event, const char *name),
               void *context);
