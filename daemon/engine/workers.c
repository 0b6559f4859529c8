/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Worker threads: choose a job, and measure a part of it. */
#include "base/clock.h"
#include "engine/internal.h"

/* ---- under the lock ---- */

/* Return whether a worker could measure a part of the job now. While another worker reads, this one
 * would only wait for the reader, maybe for long: it had better serve another job. */
static bool wants_worker(const job *j, int slot) {
    return j->phase == JOB_MEASURING && j->reading == 0 &&
           (j->seats[slot].is_member || j->members < j->team_size) &&
           !shear_work_get_status(j->work).exhausted;
}

/* Return the job to serve next: of the highest priority, and of these the least served one. NULL:
 * there is no work. */
static job *choose(engine *e, int slot) {
    job *best = NULL;
    for (job *j = e->jobs; j != NULL; j = j->next) {
        if (wants_worker(j, slot) &&
            (best == NULL || j->priority > best->priority ||
             (j->priority == best->priority && j->served < best->served))) {
            best = j;
        }
    }
    return best;
}

/* ---- measuring ---- */

/* Return whether this thread has to write a checkpoint now. Its time is recorded, so that no other
 * thread writes it, too. */
static bool checkpoint_due(engine *e, job *j) {
    const int64_t now = clock_ms(CLOCK_MONOTONIC);
    const int64_t next_block = shear_work_get_status(j->work).next_block;
    LOCKED(&e->lock);
    const bool due =
        now - j->checkpoint_ms >= e->options.checkpoint_ms && next_block > j->checkpoint_block;
    if (due) {
        j->checkpoint_ms = now;
        j->checkpoint_block = next_block;
    }
    return due;
}

/* Do one work unit of a job. The lock is held on entry and on return. */
static void serve(engine *e, job *j, int slot) {
    const int64_t unit = (int64_t)j->size.blocks * SHEAR_BLOCK;
    job_seat *seat = &j->seats[slot];
    shear_error err;
    ENGINE_ASSERT_LOCKED(e);
    assert(j->phase == JOB_MEASURING);
    j->served += unit;
    j->holders++;
    j->reading++;
    seat->entering = true;
    j->members += !seat->is_member;
    seat->is_member = true;
    e->busy++;
    pthread_mutex_unlock(&e->lock);
    job_step(j, slot, &err);
    if (checkpoint_due(e, j))
        job_save_checkpoint(j);
    pthread_mutex_lock(&e->lock);
    e->busy--;
    const int64_t done = shear_work_get_status(j->work).stamps_done; /* work units differ in size */
    e->stamps_total += done - j->counted;
    j->counted = done;
    j->reading -= seat->entering;
    seat->entering = false;
    j->holders--;
    if (job_is_measured(j))
        pthread_cond_broadcast(&e->progressed);
}

void *worker_main(void *argument) {
    const worker *w = argument;
    engine *e = w->engine;
    LOCKED(&e->lock);
    while (!e->stopping) {
        job *j = choose(e, w->slot);
        if (j != NULL) {
            serve(e, j, w->slot);
        } else {
            pthread_cond_wait(&e->work_available, &e->lock);
        }
    }
    return NULL;
}
