/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/budget.h: the memory that all jobs and kept plans may take together ([limits] memory).
 *
 * A job reserves memory before it allocates it, and waits until enough is free. It holds no
 * reservation while it waits, so no two jobs wait for each other. The waiting job of the highest
 * priority, then of the longest wait, is next, even if a smaller request would fit: otherwise a
 * large one could wait for ever.
 *
 * Called by jobs' threads, without the engine's lock. */
#pragma once

#include "engine/job.h"

#include <stdbool.h>
#include <stdint.h>

enum budget_answer {
    BUDGET_RESERVED,
    BUDGET_NEVER, /* more than the whole budget */
    BUDGET_STOP   /* the job is to stop */
};

/* Wait until `bytes` are free, and reserve them. The job has no reservation yet. */
enum budget_answer budget_wait(job *j, int64_t bytes);
/* Change the job's reservation, so far for its plan and the making of it, to `bytes` beside the
 * plan, which is counted by the cache from now on. Return false if they are not free now, having
 * given back all as budget_return does; a smaller reservation always succeeds. */
bool budget_settle(job *j, int64_t bytes);
/* Give back the job's plan, if it has one, and its reservation. */
void budget_return(job *j);
/* Return the budget of all jobs and plans, in bytes. */
int64_t budget_total(const job *j);
