/* SPDX-License-Identifier: GPL-3.0-or-later */
/* progress.h: a progress bar on standard error, and a clean stop on SIGINT and SIGTERM.
 *
 * The bar (part done, stamps per second, time left) is drawn only if standard error is a terminal.
 * Between progress_begin and progress_end the first SIGINT or SIGTERM makes progress_callback
 * return non-zero, so that the work stops with SHEAR_E_CANCELLED and cleans up. A second one ends
 * the process. There can be only one progress at a time. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

typedef struct progress progress;

/* Begin; `label` (copied) is shown before the bar. `quiet`: there is no bar. Returns NULL if out of
 * memory; all functions accept NULL. */
progress *progress_begin(const char *label, bool quiet);

/* Show that `done` of `total` stamps are done. The signature is that of shear_run_options.progress,
 * with the struct progress as its context. Returns non-zero if the user wants to stop. */
int progress_callback(void *context, int64_t done, int64_t total);

/* Show the progress of another process, at `rate` stamps per second. If `total` is unknown
 * (negative), "waiting" is shown instead of numbers. */
void progress_show(progress *progress, const char *label, int64_t done, int64_t total, double rate);
/* Return false if nothing will be drawn. */
bool progress_visible(const progress *progress);

/* Erase the bar, restore the signal handlers, and free *progress. */
void progress_end(progress *progress);

/* Return whether SIGINT or SIGTERM has arrived between progress_begin and progress_end. */
bool progress_interrupted(void);
/* Set that state, from a signal handler of another file (screen.h). */
void progress_interrupt(void);
