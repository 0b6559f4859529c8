/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/child_stderr.h: what a reader child writes to its standard error. Usually that is nothing;
 * an example is the dynamic linker's message about a missing library. */
#pragma once

#include <stddef.h>

/* Create a non-blocking pipe: ends[0] is the daemon's end, ends[1] the child's standard error.
 * Return 0, or errno with both ends -1. */
int child_stderr_pipe(int ends[2]);

/* Read the pipe into out as one line of printable text, cut to `size` bytes; "" means nothing. The
 * text is untrusted: a malicious file may have caused it. */
void child_stderr_read(int end, char *out, size_t size);
