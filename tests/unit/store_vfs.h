/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/store_vfs.h: a file system for SQLite that fails where it is told to, over the real
 * one. Files are not really synced (the tests would wait for the disk), but what a sync would have
 * made safe is remembered, so that the power can be cut. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum store_vfs_fault {
    VFS_SOUND,
    VFS_IO_ERROR,   /* one call fails; half of a write is done */
    VFS_FULL,       /* from that call on writes fail: the disk is full */
    VFS_READ_ERROR, /* one read fails; only reads count */
    VFS_POWER_CUT   /* from that call on everything fails, and what was not synced is lost
                       (store_vfs_restart) */
};

extern const char store_vfs_name[];
void store_vfs_register(void);

/* From now on count the calls that change files (write, sync, truncate, delete); the `at`-th one
 * fails (1: the next). */
void store_vfs_arm(enum store_vfs_fault fault, int64_t at);
bool store_vfs_fired(void);    /* did it come to that? */
int64_t store_vfs_calls(void); /* since armed */
int64_t store_vfs_syncs(void); /* of those, the syncs */

/* Remember synced contents from here on: needed before VFS_POWER_CUT; costs a copy of the file a
 * sync. */
void store_vfs_remember(bool on);
/* After a power cut (all files closed): bring the database `path` and its journals to their last
 * synced contents. */
void store_vfs_restart(const char *path);
