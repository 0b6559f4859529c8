/* SPDX-License-Identifier: GPL-3.0-or-later */
/* follow_sum.h: the progress of several jobs as that of one, and how they ended. */
#ifndef CLIENT_REMOTE_FOLLOW_SUM_H
#define CLIENT_REMOTE_FOLLOW_SUM_H

#include "sheard/messages.h"
#include "terminal/exit_code.h"

typedef struct follow_entry {
    int64_t id;
    enum sheard_job_state state;
    sheard_msg_progress progress;
} follow_entry;

typedef struct follow_totals {
    size_t finished;
    int64_t done, total; /* stamps; total -1: not known of any job */
    double rate;
} follow_totals;

/* Jobs whose stamps are not counted yet are taken to have as many as the others have on average. */
follow_totals follow_sum(const follow_entry *entries, size_t n);

/* What a notification or an answer says of a job that is among entries[n]. A final state stays. */
void follow_note_job(follow_entry *entries, size_t n, const sheard_msg_job *job);
void follow_note_progress(follow_entry *entries, size_t n, int64_t id,
                          const sheard_msg_progress *progress);

/* How jobs ended. */
typedef struct follow_counts {
    size_t done, failed, cancelled, unfinished;
} follow_counts;
void follow_counts_add(follow_counts *counts, enum sheard_job_state state);

/* What a command that waited for them exits with. */
enum exit_code follow_exit_code(const follow_counts *counts);

#endif
