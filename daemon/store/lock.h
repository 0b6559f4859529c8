/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/lock.h: one owner for a database, from before SQLite sees the file until after.
 *
 * SQLite's own exclusive lock is taken in steps, and of several services that start at once each
 * can stop at a step that keeps the others from the next: all are refused. The kernel's lock on a
 * file beside the database has one step, so one of them gets it. SQLite's lock is taken as well,
 * against programs that do not know this one.
 */
#ifndef SHEARD_STORE_LOCK_H
#define SHEARD_STORE_LOCK_H

#include "shear/error.h"

/* Lock `path`.lock (mode 0600, made where there is none, and never removed: another may be waiting
 * for it) and wait up to busy_ms for its owner to leave. *fd is the lock, -1 on error:
 * STORE_LOCKED, SHEAR_E_IO. Closing it, or the end of the process, is the lock's end. */
int lock_acquire(int *fd, const char *path, int busy_ms, shear_error *err);

/* The error of both locks. */
int lock_fail(const char *path, shear_error *err);

#endif
