/* SPDX-License-Identifier: GPL-3.0-or-later */
/* log/outlet.h: bytes on their way to a descriptor that may make a writer wait.
 *
 * A pipe that nobody reads, a terminal stopped by ^S or the journal's socket take no more at some
 * time, and a write waits then. Such a descriptor is written to by a thread of its own, from a
 * bounded buffer: who logs never waits. O_NONBLOCK is no way out: it would be set for everybody who
 * shares the open file, the user's shell too. A regular file is written to at once.
 *
 * Any thread may call. */
#ifndef LOG_OUTLET_H
#define LOG_OUTLET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { OUTLET_BYTES = 256 * 1024 };

/* Write there from now on; before the first call it is standard error, written to at once. What
 * still waits goes to the new one. */
void outlet_open(int fd);
/* All n bytes (at most OUTLET_BYTES), or nothing: false where there is no room for them. */
bool outlet_put(const char *bytes, size_t n);
/* Wait until all is written; false: timeout_ms were over before. */
bool outlet_drain(int timeout_ms);
size_t outlet_waiting(void); /* bytes that are not written yet */

#endif
