/* SPDX-License-Identifier: GPL-3.0-or-later */
/* progress.h: a progress bar on standard error, and a clean stop on SIGINT and SIGTERM.
 *
 * The bar (part done, stamps per second, time left) is drawn only where standard error is a
 * terminal. Between progress_begin and progress_end a first SIGINT or SIGTERM makes
 * progress_callback return non-zero, so that the work stops with SHEAR_E_CANCELLED and cleans up; a
 * second one ends the process. One progress at a time.
 */
#ifndef CLIENT_TERMINAL_PROGRESS_H
#define CLIENT_TERMINAL_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct progress progress;

/* Begin; `label` (copied) is shown before the bar. NULL when memory is out: all calls accept
 * it. */
progress *progress_begin(const char *label);
/* The same without a bar (--quiet). */
progress *progress_begin_quiet(void);

/* Show that `done` of `total` stamps are done. The signature is that of shear_run_options.progress,
 * with the struct progress as its context. Returns non-zero when the user wants to stop. */
int progress_callback(void *context, int64_t done, int64_t total);

/* The same for work that somebody else does, at `rate` stamps per second. `total` is negative where
 * it is not known: then nothing but waiting is shown. */
void progress_show(progress *progress, const char *label, int64_t done, int64_t total, double rate);
/* False if nothing will be drawn. */
bool progress_visible(const progress *progress);

/* Take the bar off the screen, give the signals back, free. */
void progress_end(progress *progress);

/* True after a SIGINT or SIGTERM between progress_begin and progress_end. */
bool progress_interrupted(void);
/* Make it so, from a signal handler of somebody else (screen.h). */
void progress_interrupt(void);

#endif
