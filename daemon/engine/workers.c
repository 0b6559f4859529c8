/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The workers: which job a worker serves next, and what it does there. */
#include "engine/internal.h"

#include <stdlib.h>

/* ---- under the lock ---- */

/* Whether a worker could measure something of the job now. While another one reads, it could only
 * wait for the reader, and if that hangs, for long: there may be other jobs. */
static bool wants_worker(const job *j, int slot) {
    return j->phase == JOB_MEASURING && j->reading == 0 &&
           (j->is_member[slot] || j->members < j->team_size) &&
           !shear_work_get_status(j->work).exhausted;
}

/* The job to serve next: highest priority, then the one that was served least. */
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

/* One will do, unless it may be one that the job has no memory for. */
void workers_call(engine *e, const job *j) {
    if (j->team_size < j->workers) {
        pthread_cond_broadcast(&e->work_there);
    } else {
        pthread_cond_signal(&e->work_there);
    }
}

/* ---- measuring ---- */

void worker_save(engine *e, job *j) {
    engine_event event = {.kind = ENGINE_CHECKPOINT, .job = j->id};
    shear_error ignored;
    pthread_mutex_lock(&j->saving); /* checkpoints are queued in the order of their blocks */
    if (job_checkpoint(j, &event, &ignored) == SHEAR_OK) {
        engine_emit(e, &event, NULL);
    }
    pthread_mutex_unlock(&j->saving);
}

/* Whether this thread is the one to write the checkpoint that is due; it is not due again at once.
 */
static bool checkpoint_due(engine *e, job *j) {
    const int64_t now = (int64_t)(1e3 * engine_now_s());
    const int64_t next_block = shear_work_get_status(j->work).next_block;
    pthread_mutex_lock(&e->lock);
    const bool due =
        now - j->checkpoint_ms >= e->options.checkpoint_ms && next_block > j->checkpoint_block;
    if (due) {
        j->checkpoint_ms = now;
        j->checkpoint_block = next_block;
    }
    pthread_mutex_unlock(&e->lock);
    return due;
}

/* The first read of a worker that has come in was counted when it came. */
void job_read_begins(job *j, int slot) {
    engine *e = j->engine;
    pthread_mutex_lock(&e->lock);
    j->reading += !j->entering[slot];
    j->entering[slot] = false;
    pthread_mutex_unlock(&e->lock);
}

void job_read_ends(job *j) {
    engine *e = j->engine;
    pthread_mutex_lock(&e->lock);
    j->reading--;
    workers_call(e, j);
    pthread_mutex_unlock(&e->lock);
}

/* A file's last turn has fewer stamps than others. The lock is held. */
static void count_stamps(engine *e, job *j) {
    const int64_t done = shear_work_get_status(j->work).stamps_done;
    e->stamps_total += done - j->counted;
    j->counted = done;
}

/* Serve a job once; the lock is held on entry and on return. */
static void serve(engine *e, job *j, int slot) {
    const int64_t turn = (int64_t)j->size.blocks * SHEAR_BLOCK;
    shear_error err;
    j->served += turn;
    j->holders++;
    j->reading++;
    j->entering[slot] = true;
    j->members += !j->is_member[slot];
    j->is_member[slot] = true;
    e->busy++;
    pthread_mutex_unlock(&e->lock);
    job_step(j, slot, &err);
    if (checkpoint_due(e, j)) {
        worker_save(e, j);
    }
    pthread_mutex_lock(&e->lock);
    e->busy--;
    count_stamps(e, j);
    j->reading -= j->entering[slot];
    j->entering[slot] = false;
    j->holders--;
    if (course_is_measured(j)) {
        pthread_cond_broadcast(&e->moved);
    }
}

void *worker_main(void *argument) {
    worker_start start = *(worker_start *)argument;
    free(argument);
    engine *e = start.e;
    pthread_mutex_lock(&e->lock);
    while (!e->ending) {
        job *j = choose(e, start.slot);
        if (j != NULL) {
            serve(e, j, start.slot);
        } else {
            pthread_cond_wait(&e->work_there, &e->lock);
        }
    }
    pthread_mutex_unlock(&e->lock);
    return NULL;
}
