/* SPDX-License-Identifier: GPL-3.0-or-later */
/* follow_sum.h: the total progress of several jobs, and the counts of how they ended. */
#pragma once

#include "sheard/messages.h"
#include "terminal/exit_code.h"

typedef struct follow_entry {
    int64_t id;
    enum sheard_job_state state;
    sheard_msg_progress progress;
} follow_entry;

typedef struct follow_totals {
    size_t finished;
    int64_t done, total; /* stamps; total -1: unknown for all jobs */
    double rate;
} follow_totals;

/* Return the total progress. Jobs with an unknown number of stamps count with the mean of the
 * others. */
follow_totals follow_sum(const follow_entry *entries, size_t n);

/* Update the entry of the job in entries[n] from a notification or reply. A final state does not
 * change any more. */
void follow_note(follow_entry *entries, size_t n, int64_t id, enum sheard_job_state state,
                 const sheard_msg_progress *progress);

/* Numbers of jobs by how they ended. */
typedef struct follow_counts {
    size_t done, failed, cancelled, unfinished;
} follow_counts;
void follow_counts_add(follow_counts *counts, enum sheard_job_state state);

/* Return the exit code of a command that waited for the jobs. */
enum exit_code follow_exit_code(const follow_counts *counts);
