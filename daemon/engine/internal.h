/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/internal.h: what the files of the engine share.
 *
 * Threads: a worker measures, and does nothing that may wait for a strange file beyond one read. A
 * job has a thread of its own (job_thread.c), which opens it, starts and stops its reader, and
 * finishes it: hashing, a file that hangs and a slow disk hold up that job only.
 *
 * One lock guards the list of jobs and what job.h says. It is never held while a job is worked on;
 * a worker inside a job has counted itself into job->holders, and the job's thread frees the job
 * only when nobody holds it. */
#ifndef SHEARD_ENGINE_INTERNAL_H
#define SHEARD_ENGINE_INTERNAL_H

#include "engine/engine.h"
#include "engine/event_queue.h"
#include "engine/job.h"

#include <assert.h>
#include <errno.h>
#include <pthread.h>

struct engine {
    engine_options options;
    char *program, *scratch;
    atomic_llong scratch_used; /* bytes, by all readers */
    pthread_t *threads;        /* workers */
    int n_threads;
    plan_cache *plans;  /* has a lock of its own, which is acquired under this one's, never the
                           other way */
    event_queue events; /* likewise */

    pthread_mutex_t lock;
    pthread_cond_t work_available; /* for workers: a job may have something to do, or `stopping` */
    pthread_cond_t progressed;     /* for the jobs' threads: a job has come on, or memory is free;
                                      and for engine_free */
    bool stopping;
    job *jobs;
    struct {
        int64_t total, reserved, tickets;
    } budget;        /* budget.h */
    int job_threads; /* that have not ended */
    int busy;
    int64_t stamps_total;
};

/* Called where the lock is held. */
#define ENGINE_ASSERT_LOCKED(e) assert(pthread_mutex_trylock(&(e)->lock) == EBUSY)

#endif
