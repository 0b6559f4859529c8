/* SPDX-License-Identifier: GPL-3.0-or-later */
/* log/outlet.h: write the log without blocking the thread that logs.
 *
 * A write to a pipe that nobody reads, to a terminal stopped by ^S or to the journal's socket may
 * block. A thread of its own writes to such a descriptor, from a bounded buffer. O_NONBLOCK cannot
 * be used: it would apply to all who share the open file, the user's shell too. A regular file is
 * written to at once.
 *
 * Any thread may call. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { OUTLET_BYTES = 256 * 1024 };

/* Write to fd from now on, also what is still buffered. Before the first call, bytes are written to
 * standard error at once. */
void outlet_open(int fd);
/* Write or buffer all n bytes (at most OUTLET_BYTES). Return false, with none of them written, if
 * the buffer lacks the room. */
bool outlet_put(const char *bytes, size_t n);
/* Wait until all is written. Return false after timeout_ms. */
bool outlet_drain(int timeout_ms);
size_t outlet_waiting(void); /* bytes not written yet */
