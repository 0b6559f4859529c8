/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/follow_sum.h"

#include <math.h>

follow_totals follow_sum(const follow_entry *entries, size_t n) {
    follow_totals sum = {.total = -1};
    double known = 0.0;
    size_t n_known = 0;
    for (size_t i = 0; i < n; i++) {
        const follow_entry *e = &entries[i];
        const bool final = sheard_job_state_is_final(e->state);
        sum.finished += final;
        if (e->progress.total >= 0) {
            known += (double)e->progress.total;
            n_known++;
            sum.done += final ? e->progress.total : e->progress.done;
        }
        if (e->state == SHEARD_JOB_RUNNING && isfinite(e->progress.rate))
            sum.rate += e->progress.rate;
    }
    if (n_known > 0)
        sum.total = (int64_t)(known / (double)n_known * (double)n + 0.5);
    return sum;
}

void follow_note(follow_entry *entries, size_t n, int64_t id, enum sheard_job_state state,
                 const sheard_msg_progress *progress) {
    for (size_t i = 0; i < n; i++) {
        follow_entry *e = &entries[i];
        if (e->id == id && !sheard_job_state_is_final(e->state)) {
            e->state = state;
            e->progress = *progress;
            return;
        }
    }
}

void follow_counts_add(follow_counts *counts, enum sheard_job_state state) {
    counts->done += state == SHEARD_JOB_DONE;
    counts->failed += state == SHEARD_JOB_FAILED;
    counts->cancelled += state == SHEARD_JOB_CANCELLED || state == SHEARD_JOB_RETRACTED;
    counts->unfinished += !sheard_job_state_is_final(state);
}

enum exit_code follow_exit_code(const follow_counts *t) {
    if (t->unfinished > 0)
        return EXIT_CODE_TIMED_OUT;
    if (t->failed + t->cancelled == 0)
        return EXIT_CODE_DONE;
    if (t->done > 0)
        return EXIT_CODE_PARTLY;
    return t->failed > 0 ? EXIT_CODE_JOB_FAILED : EXIT_CODE_CANCELLED;
}
