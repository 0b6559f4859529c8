/* SPDX-License-Identifier: GPL-3.0-or-later */
/* progress.h: a progress line on standard error: part done, speed, remaining time.
 *
 * On a terminal the line is redrawn; otherwise (a log file) a new line is written every minute. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* Begin. `total`: number of stamps that will be drawn. */
void progress_begin(int64_t total, bool quiet);
/* Add finished stamps; `cached` ones took no time. */
void progress_add(const char *label, int64_t stamps, bool cached);
/* Erase the line. */
void progress_end(void);
