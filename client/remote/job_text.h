/* SPDX-License-Identifier: GPL-3.0-or-later */
/* job_text.h: jobs as text: rows of a table, and all details of one job. */
#pragma once

#include "sheard/messages.h"
#include "terminal/text_table.h"

#include <stdbool.h>

/* Return the style of a job's state on a terminal (style.h), or NULL. */
const char *job_state_style(enum sheard_job_state state);

/* Return a new table for `shearctl jobs`. */
text_table *job_table_new(void);
void job_table_add(text_table *table, const sheard_msg_job *job, int64_t now_ms);

/* Return a new table of finished jobs with their shear (submit --wait, wait). */
text_table *job_results_new(void);
void job_results_add(text_table *table, const sheard_msg_job *job);

/* Print the output of `shearctl show`. */
void job_text_print(const sheard_msg_shown *shown, bool utc, FILE *out);

/* Write "/data/a.fits", or "/data/gal.fits[2] + ..." for separate parts, into buf. For a dropped
 * file, write its original name and its current place: "a.fits (failed/a.1.fits)". Returns buf. */
char *job_source_text(const sheard_msg_job *job, char *buf, size_t size);

/* Return whether a running job has not started to measure. */
bool job_is_before_measuring(const sheard_msg_job *job);
/* Write its phase then, "hashing, 42% of 3.1 MB", or else a bar of `width` columns and the numbers
 * after it, into buf. Returns buf. */
char *job_progress_text(const sheard_msg_job *job, int width, char *buf, size_t size);

/* Print to standard error why a job is not done, with the advice; nothing if it is done. */
void job_complain(const sheard_msg_job *job);
