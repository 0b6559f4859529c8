/* SPDX-License-Identifier: GPL-3.0-or-later */
/* job_text.h: jobs for people: rows of a table, and everything about one. */
#ifndef CLIENT_REMOTE_JOB_TEXT_H
#define CLIENT_REMOTE_JOB_TEXT_H

#include "sheard/messages.h"
#include "terminal/text_table.h"

#include <stdbool.h>

/* The colour of a job's state on a terminal (style.h), or NULL. */
const char *job_state_style(enum sheard_job_state state);

/* The table of `shearctl jobs`. */
text_table *job_table_new(void);
void job_table_add(text_table *table, const sheard_msg_job *job, int64_t now_ms);

/* The table of finished jobs with their shear (submit --wait, wait). */
text_table *job_results_new(void);
void job_results_add(text_table *table, const sheard_msg_job *job);

/* `shearctl show`. */
void job_text_print(const sheard_msg_shown *shown, bool utc, FILE *out);

/* "/data/a.fits", or "/data/gal.fits[2] + ..." of separate images; of a dropped file the name that
 * it had and where it is now: "a.fits (failed/a.1.fits)". Returns buf. */
char *job_source_text(const sheard_msg_job *job, char *buf, size_t size);

/* A running job that is not yet measured: what it is at is its phase, "hashing, 42% of 3.1 MB". */
bool job_is_before_measuring(const sheard_msg_job *job);
const char *job_phase_text(const sheard_msg_progress *progress, char *buf, size_t size);

/* A bar of `width` columns, and the figures behind it. Returns buf. */
char *job_bar_text(const sheard_msg_progress *progress, int width, char *buf, size_t size);

/* Why a job is not done, with its advice, on standard error; nothing for one that is. */
void job_complain(const sheard_msg_job *job);

#endif
