/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/budget.h: the memory that the jobs may take together ([limits] memory): what they have
 * reserved, and the kept plans, which several may share. A job reserves what it is going to take
 * before it takes it, and waits until there is room; it holds nothing while it waits, so that no
 * two wait for each other. The one that comes first in priority, then in time, is next, also where
 * a smaller one would fit: else a large one would wait for ever.
 *
 * Called by jobs' threads, without the engine's lock. */
#ifndef SHEARD_ENGINE_BUDGET_H
#define SHEARD_ENGINE_BUDGET_H

#include "engine/job.h"

#include <stdbool.h>
#include <stdint.h>

enum budget_answer {
    BUDGET_RESERVED,
    BUDGET_NEVER, /* more than there is for all */
    BUDGET_STOP   /* the job is to stop */
};

/* Give back what the job has reserved, wait for room, and reserve `bytes`. */
enum budget_answer budget_wait(job *j, int64_t bytes);
/* Reserve `bytes` instead of what the job has now, if that is possible at once (of less, it is). */
bool budget_change(job *j, int64_t bytes);
/* What all may take together, now. */
int64_t budget_total(const job *j);

#endif
