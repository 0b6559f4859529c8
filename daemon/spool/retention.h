/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/retention.h: remove files from done/ and failed/ that are too old or too many, in small
 * steps. */
#pragma once

#include "spool/folders.h"
#include "spool/spool.h"

#include <dirent.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/* A file, with its report if it has one. */
typedef struct ended_file {
    char *name;
    ino_t inode;
    int64_t modified_ns, ended_ns; /* since 1970; ended_ns: when it was moved here */
    int64_t bytes;                 /* file and report together */
    bool has_report, is_report;
} ended_file;

typedef struct retention {
    enum folder folder; /* the one being processed; N_FOLDERS: none */
    DIR *dir;           /* open while the folder is being read */
    ended_file *items;
    size_t n, capacity;
    size_t next;   /* index of the first item not yet removed */
    int64_t bytes; /* of the items from `next` on */
} retention;

void retention_init(retention *w);
void retention_deinit(retention *w);
void retention_begin(retention *w); /* unless it is under way */
/* Do some of the work. Return true if there is more. */
bool retention_step(spool *s);
