/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/retention.h: what is too old or too much in done/ and failed/ is removed, in small steps.
 */
#ifndef SHEARD_SPOOL_RETENTION_H
#define SHEARD_SPOOL_RETENTION_H

#include "spool/folders.h"
#include "spool/spool.h"

#include <dirent.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/* A file, with its report where there is one. */
typedef struct ended_file {
    char *name;
    ino_t inode;
    int64_t modified_ns, ended_ns; /* since 1970 */
    int64_t bytes;                 /* of both */
    bool has_report, is_report;
} ended_file;

typedef struct retention {
    enum folder folder; /* the one under way; N_FOLDERS: none */
    DIR *dir;           /* open while it is being read */
    ended_file *items;
    size_t n, capacity;
    size_t next;   /* the first item not yet removed */
    int64_t bytes; /* of those from next on */
} retention;

void retention_init(retention *w);
void retention_deinit(retention *w);
void retention_begin(retention *w); /* unless one is under way */
bool retention_idle(const retention *w);
/* Some of the work. True: there is more. */
bool retention_step(spool *s);

#endif
