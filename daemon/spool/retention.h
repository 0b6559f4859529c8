/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Retention: what is too old or too much in done/ and failed/ is removed, in small steps. */
#ifndef SHEARD_SPOOL_SWEEP_H
#define SHEARD_SPOOL_SWEEP_H

#include <dirent.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/* A file, with its report where there is one. */
typedef struct sweep_item {
    char *name;
    ino_t inode;
    int64_t modified_ns, ended_ns; /* since 1970 */
    int64_t bytes;                 /* of both */
    bool has_report, is_report;
} sweep_item;

typedef struct sweep {
    int folder; /* the one under way; N_FOLDERS: none */
    DIR *dir;   /* open while it is being read */
    sweep_item *items;
    size_t n, room;
    size_t next;   /* read: the first item not yet removed */
    int64_t bytes; /* of those from next on */
} sweep;

void sweep_init(sweep *w);
void sweep_deinit(sweep *w);
void sweep_begin(sweep *w); /* unless one is under way */
bool sweep_idle(const sweep *w);

#endif
