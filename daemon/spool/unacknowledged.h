/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/unacknowledged.h: files in active/ that the owner has not accepted yet. */
#pragma once

#include <stdbool.h>
#include <sys/queue.h>

typedef struct unacknowledged_file {
    TAILQ_ENTRY(unacknowledged_file) link;
    bool again; /* it has been reported before */
    char active_name[];
} unacknowledged_file;
TAILQ_HEAD(unacknowledged_queue, unacknowledged_file);

typedef struct unacknowledged {
    struct unacknowledged_queue pending;
    struct unacknowledged_queue refused; /* wait for the next scan or spool_wake */
    bool unsynced;                       /* files were moved to active/ since the last fsync */
} unacknowledged;

void unacknowledged_init(unacknowledged *o);
void unacknowledged_deinit(unacknowledged *o);
/* Add a file, to the refused ones if `refused`. Return false if out of memory. */
bool unacknowledged_add(unacknowledged *o, const char *active_name, bool again, bool refused);
void unacknowledged_remove(unacknowledged *o, const char *active_name);
/* Make the refused files pending. */
void unacknowledged_retry(unacknowledged *o);
/* Remove the next pending file from the list and return it, the caller's to free, or NULL if no
 * file is pending. */
unacknowledged_file *unacknowledged_next(unacknowledged *o);
bool unacknowledged_pending(const unacknowledged *o);
