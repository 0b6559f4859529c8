/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Run one job in a thread of its own. This thread starts the reader, and must outlive it: the
 * kernel kills a child whose parent thread ends (PR_SET_PDEATHSIG). */
#include "engine/internal.h"

static void set_phase(engine *e, job *j, enum job_phase phase) {
    LOCKED(&e->lock);
    j->phase = phase;
}

/* Wait for engine_go or a stop. Return true if the job is to be measured. */
static bool wait_for_go(engine *e, job *j) {
    LOCKED(&e->lock);
    while (!j->go && !j->stop_asked)
        pthread_cond_wait(&e->progressed, &e->lock);
    return !j->stop_asked;
}

/* Let the workers measure the job, and wait until they have finished. */
static void wait_until_measured(engine *e, job *j) {
    LOCKED(&e->lock);
    assert(j->phase == JOB_OPENED);
    j->phase = JOB_MEASURING;
    j->counted =
        shear_work_get_status(j->work).stamps_done; /* before a checkpoint: counted already */
    atomic_store(&j->stage, ENGINE_MEASURING);
    if (j->stop_asked)
        shear_work_stop(j->work);
    job_call_workers(j);
    while (!job_is_measured(j))
        pthread_cond_wait(&e->progressed, &e->lock);
    j->phase = JOB_FINISHING;
    atomic_store(&j->stage, ENGINE_FINISHING);
}

/* Measure an opened job. *event becomes its last event. */
static void measure(engine *e, job *j, engine_event *event) {
    *event = (engine_event){.kind = ENGINE_STOPPED, .job = j->id};
    if (!wait_for_go(e, j))
        return;
    if (job_begin(j, &event->error) != SHEAR_OK) {
        event->kind = ENGINE_FAILED;
        return;
    }
    if (j->sums_before != NULL) {
        const engine_event resumed = {
            .kind = ENGINE_RESUMED, .job = j->id, .next_block = j->checkpoint_block};
        event_queue_push(&e->events, &resumed, NULL);
    }
    wait_until_measured(e, j);
    job_finish(j, event);
    if (event->kind == ENGINE_STOPPED)
        job_save_checkpoint(j);
}

static void unlink_job(engine *e, job *j) {
    LOCKED(&e->lock);
    job **at = &e->jobs;
    while (*at != j)
        at = &(*at)->next;
    *at = j->next;
}

void *job_thread_main(void *argument) {
    job *j = argument;
    engine *e = j->engine;
    engine_event event;
    job_prepare(j, &event);
    if (event.kind == ENGINE_OPENED) {
        set_phase(e, j, JOB_OPENED);
        event_queue_push(&e->events, &event, NULL);
        measure(e, j, &event);
    }
    unlink_job(e, j);
    job_free(j);
    const pthread_t self = pthread_self();
    event_queue_push(&e->events, &event, &self);
    LOCKED(&e->lock);
    e->job_threads--;
    pthread_cond_broadcast(&e->progressed);
    return NULL;
}
