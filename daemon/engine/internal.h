/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/internal.h: what the files of the engine share.
 *
 * Threads: a worker measures, and does nothing that may wait for a strange file beyond one read. A
 * job has a thread of its own (course.c), which opens it, starts and stops its reader, and finishes
 * it: hashing, a file that hangs and a slow disk hold up that job only.
 *
 * One lock guards the list of jobs and what job.h says. It is never held while a job is worked on;
 * a worker inside a job has counted itself into job->holders, and the job's thread frees the job
 * only when nobody holds it. */
#ifndef SHEARD_ENGINE_INNER_H
#define SHEARD_ENGINE_INNER_H

#include "engine/engine.h"
#include "engine/events.h"
#include "engine/job.h"

#include <pthread.h>

struct engine {
    engine_options options;
    char *program, *scratch;
    atomic_llong scratch_used; /* bytes, by all readers */
    pthread_t *threads;        /* workers */
    int n_threads;
    plans *plans;  /* has a lock of its own, which is taken under this one's, never the other way */
    events events; /* as well */

    pthread_mutex_t lock;
    pthread_cond_t work_there; /* for workers: a job may have something to do, or `ending` */
    pthread_cond_t moved; /* for the jobs' threads: a job has come on, or memory is free; and for
                             engine_free */
    bool ending;
    job *jobs;
    struct {
        int64_t total, reserved, tickets;
    } budget;    /* budget.h */
    int courses; /* threads of jobs */
    int busy;
    int64_t stamps_total;
};

/* pthread_create, with all signals blocked in the new thread: they are the loop's. */
int engine_thread(pthread_t *thread, void *(*start)(void *), void *argument);

/* Queue an event and wake the owner; `ending` as in events_push. */
void engine_emit(engine *e, const engine_event *event, const pthread_t *ending);

/* ---- workers.c ---- */

/* Under the lock: a job may have something for a worker. */
void workers_call(engine *e, const job *j);

/* The workers' thread; the argument is a worker_start, which is freed. */
typedef struct worker_start {
    engine *e;
    int slot;
} worker_start;
void *worker_main(void *start);
/* Save the sums of a job where something new has been joined. */
void worker_save(engine *e, job *j);

/* ---- course.c ---- */

/* The thread of a job that is in the list; the argument is the job. */
void *course_main(void *j);
/* Under the lock: has a job that is being measured nothing left to do, and nobody in it? */
bool course_is_measured(const job *j);

#endif
