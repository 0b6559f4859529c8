/* SPDX-License-Identifier: GPL-3.0-or-later */
/* progress.h: one line on standard error: what is done, how fast, how long it will still take.
 *
 * On a terminal the line is redrawn; elsewhere (a log file) there is a new one every minute. */
#ifndef VALIDATION_PROGRESS_H
#define VALIDATION_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

/* `total`: stamps that all will draw. */
void progress_begin(int64_t total, bool quiet);
/* So many more stamps are done; `cached` ones cost nothing. */
void progress_add(const char *label, int64_t stamps, bool cached);
/* Take the line off the screen. */
void progress_end(void);

#endif
