/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/lock.h: the lock file: one owner of a database, from before SQLite opens the file until
 * after it closes it.
 *
 * SQLite takes its own exclusive lock in steps. If several services start at once, each may stop at
 * a step that keeps the others from the next, and all are refused. The kernel's lock on a file
 * beside the database has one step, so one service gets it. SQLite's lock is taken, too, against
 * programs that do not know this one. */
#pragma once

#include "shear/error.h"

/* Lock `path`.lock (mode 0600, made if it is missing; never removed, since another process may wait
 * for it), waiting up to busy_ms for its owner to release it. *fd holds the lock until it is closed
 * or the process ends; -1 on error: STORE_LOCKED, SHEAR_E_IO. */
int lock_acquire(int *fd, const char *path, int busy_ms, shear_error *err);

/* Fail with STORE_LOCKED, as for both locks. */
int lock_fail(const char *path, shear_error *err);
