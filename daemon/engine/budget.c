/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/budget.h"

#include "engine/internal.h"

/* ---- under the lock ---- */

static bool comes_first(const engine *e, const job *j) {
    for (const job *other = e->jobs; other != NULL; other = other->next) {
        const bool waits = other->waiting_since > 0 && other != j;
        if (waits && (other->priority > j->priority || (other->priority == j->priority &&
                                                        other->waiting_since < j->waiting_since))) {
            return false;
        }
    }
    return true;
}

/* Return whether `more` bytes can be reserved. Idle plans are freed for it. */
static bool has_room(engine *e, int64_t more) {
    const int64_t left = e->budget.total - e->budget.reserved - more;
    return left >= 0 && plan_cache_shrink_to(e->plans, left) <= left;
}

static void reserve(engine *e, job *j, int64_t bytes) {
    ENGINE_ASSERT_LOCKED(e);
    e->budget.reserved += bytes - j->reserved;
    assert(e->budget.reserved >= 0);
    j->reserved = bytes;
    pthread_cond_broadcast(&e->progressed);
}

static void give_back(engine *e, job *j) {
    plan_cache_release(e->plans, j->plan);
    j->plan = NULL;
    reserve(e, j, 0);
}

/* ---- public functions ---- */

enum budget_answer budget_wait(job *j, int64_t bytes) {
    engine *e = j->engine;
    enum budget_answer answer = BUDGET_RESERVED;
    LOCKED(&e->lock);
    assert(j->phase == JOB_PREPARING && bytes >= 0);
    assert(j->reserved == 0);
    const int stage = atomic_load(&j->stage);
    j->waiting_since = ++e->budget.tickets;
    while (answer == BUDGET_RESERVED && !(comes_first(e, j) && has_room(e, bytes))) {
        if (bytes > e->budget.total) {
            answer = BUDGET_NEVER;
        } else if (j->stop_asked) {
            answer = BUDGET_STOP;
        } else {
            atomic_store(&j->stage, ENGINE_WAITING_MEMORY);
            pthread_cond_wait(&e->progressed, &e->lock);
        }
    }
    j->waiting_since = 0;
    atomic_store(&j->stage, stage);
    reserve(e, j, answer == BUDGET_RESERVED ? bytes : 0); /* wakes those that waited behind it */
    return answer;
}

bool budget_settle(job *j, int64_t bytes) {
    engine *e = j->engine;
    LOCKED(&e->lock);
    plan_cache_count(e->plans, j->plan);
    const bool possible = bytes <= j->reserved || has_room(e, bytes - j->reserved);
    if (possible) {
        reserve(e, j, bytes);
    } else {
        give_back(e, j);
    }
    return possible;
}

void budget_return(job *j) {
    LOCKED(&j->engine->lock);
    give_back(j->engine, j);
}

int64_t budget_total(const job *j) {
    LOCKED(&j->engine->lock);
    return j->engine->budget.total;
}
