/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/internal.h: the engine's state, for its own files only.
 *
 * Threads: a worker measures, and waits for the files of a job only within one read. Each job has a
 * thread of its own (job_thread.c), which opens it, starts and stops its reader, and finishes it:
 * so hashing, a file that hangs and a slow disk delay that job only.
 *
 * One lock guards the list of jobs and the members named in job.h. It is never held while a job is
 * worked on. A worker inside a job is counted in job->holders, and the job's thread frees the job
 * only when that is 0. */
#pragma once

#include "base/thread.h"
#include "engine/engine.h"
#include "engine/event_queue.h"
#include "engine/job.h"

#include <assert.h>
#include <errno.h>
#include <pthread.h>

/* A worker thread. */
typedef struct worker {
    engine *engine;
    int slot; /* its index */
    pthread_t thread;
} worker;

struct engine {
    engine_options options;
    char *program, *scratch;
    atomic_llong scratch_used; /* bytes of unpacked copies, of all readers */
    worker *workers;           /* [n_workers] */
    int n_workers;
    plan_cache *plans;  /* has a lock of its own, which may be acquired under `lock`, but not the
                           other way */
    event_queue events; /* likewise */

    pthread_mutex_t lock;
    pthread_cond_t work_available; /* for workers: a job may have work, or `stopping` is set */
    pthread_cond_t progressed;     /* job threads and engine_free wait for it: a job has progressed,
                                      memory is free, or a thread ends */
    bool stopping;
    job *jobs;
    struct {
        int64_t total, reserved, tickets;
    } budget;        /* budget.h */
    int job_threads; /* job threads that have not ended */
    int busy;
    int64_t stamps_total;
};

/* The main functions of the threads. A worker, of the argument's slot, measures the stamps of all
 * jobs until the engine stops. A job's own thread runs the job, in the engine's list, from opening
 * its files to its last event, and frees it. */
void *worker_main(void *worker);
void *job_thread_main(void *job);

/* Assert that the engine's lock is held. */
#define ENGINE_ASSERT_LOCKED(e) assert(pthread_mutex_trylock(&(e)->lock) == EBUSY)
