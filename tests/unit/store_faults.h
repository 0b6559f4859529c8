/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/store_faults.h: stores whose disk fails, and all that a database says, to compare
 * before and after. */
#pragma once

#include "store_fixture.h"
#include "store_vfs.h"

#include <stdint.h>

enum { REOPEN_MS = 5000 };

/* All that the database says, as one number. */
uint64_t said_by(store *s);

/* The code of an operation that met this fault. */
int meaning_of(enum store_vfs_fault fault);

/* Copy a file, over another if there is one. */
void copy(const char *from, const char *to);

/* How the store runs: a log that is brought into the database at every commit, and a cache so small
 * that the log is written long before the commit, make the disk busier. */
enum { PLAIN, BUSY };

/* Close the empty store, and keep it for begin(). */
void keep_empty(fixture *f);

/* Open a copy of the empty store, and fill it: making an empty one takes longer than all the rest.
 */
void begin(fixture *f, int mode);

/* Close and open the store, later; what it says then. */
uint64_t restart(fixture *f);
