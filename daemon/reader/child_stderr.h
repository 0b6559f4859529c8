/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/child_stderr.h: what a reader child writes to its standard error, which is mostly nothing:
 * the dynamic linker's complaint of a missing library, say. */
#ifndef SHEARD_READER_CHILD_STDERR_H
#define SHEARD_READER_CHILD_STDERR_H

#include <stddef.h>

/* A pipe that neither end waits on: ends[0] is the daemon's, ends[1] the child's standard error.
 * Returns 0 or errno, then both are -1. */
int child_stderr_pipe(int ends[2]);

/* What is in the pipe, as one line of printable text, cut to `size` bytes ("": nothing). Whoever
 * wrote it may have been a stranger's file. */
void child_stderr_read(int end, char *out, size_t size);

#endif
