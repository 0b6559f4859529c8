/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of incoming/ as they are known: by name, and in two queues. */
#ifndef SHEARD_SPOOL_WAITING_H
#define SHEARD_SPOOL_WAITING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/queue.h>
#include <sys/stat.h>

enum waiting_state {
    WAITING_SETTLING, /* queue by since_ms */
    WAITING_BEGUN,    /* being written, it seems; queue by since_ms, too */
    WAITING_READY,    /* queue by arrival here */
    WAITING_IGNORED,
    WAITING_N_STATES
};

/* What tells whether a file was touched. */
typedef struct waiting_print {
    dev_t device;
    ino_t inode;
    off_t size;
    struct timespec modified, changed;
} waiting_print;
waiting_print waiting_print_of(const struct stat *st);
/* The same file with, as far as can be seen, the same content; its owner or mode may have changed,
 * and it may have been renamed. */
bool waiting_same_content(const waiting_print *a, const waiting_print *b);
bool waiting_same(const waiting_print *a, const waiting_print *b);

typedef struct waiting_file {
    TAILQ_ENTRY(waiting_file) link;
    char *name;
    int state;
    int reason; /* why it is ignored: the caller's number; 0 = not told yet */

    uint64_t generation; /* the last scan that saw it */
    int64_t since_ms;    /* settling, begun: it has this print since then */
    waiting_print print;
} waiting_file;
TAILQ_HEAD(waiting_queue, waiting_file);

typedef struct waiting {
    waiting_file **files; /* [n], sorted by name */
    size_t n, room;
    struct waiting_queue queues[WAITING_N_STATES];
    size_t counts[WAITING_N_STATES];
} waiting;

void waiting_init(waiting *w);
void waiting_deinit(waiting *w);
waiting_file *waiting_find(const waiting *w, const char *name); /* or NULL */
/* A new one, ignored; the name is not yet there. NULL: out of memory. */
waiting_file *waiting_add(waiting *w, const char *name);
void waiting_remove(waiting *w, waiting_file *file);
void waiting_forget_others(waiting *w, uint64_t generation); /* those that it did not see */
/* Put it at the end of that state's queue. */
void waiting_set(waiting *w, waiting_file *file, int state);
waiting_file *waiting_first(const waiting *w, int state); /* or NULL */
waiting_file *waiting_next(const waiting_file *file);     /* of the same state; or NULL */

#endif
