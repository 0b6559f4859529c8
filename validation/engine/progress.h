/* SPDX-License-Identifier: GPL-3.0-or-later */
/* progress.h: one line on standard error: what is done, how fast, how long it will still take.
 *
 * On a terminal the line is redrawn; elsewhere (a log file) there is a new one every minute. */
#ifndef VALIDATION_PROGRESS_H
#define VALIDATION_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct progress {
    bool visible, terminal, drawn;
    int64_t total, skipped, done; /* stamps; `skipped` were finished before and cost nothing */
    double begun, shown;          /* monotonic seconds */
};

/* `total` may be 0 and raised later. */
void progress_begin(struct progress *p, int64_t total, bool quiet);
void progress_add(struct progress *p, const char *label, int64_t stamps, bool skipped);
/* Take the line off the screen. */
void progress_end(struct progress *p);

double progress_seconds(void); /* monotonic */

#endif
