/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Create the engine and its threads, and serve the calls of its owner. */
#include "base/cleanup.h"
#include "engine/internal.h"

#include <stdlib.h>
#include <string.h>

CLEANUP_DEFINE(engine, engine_free)
CLEANUP_DEFINE(shear_symmetry, shear_symmetry_free)

bool engine_next_event(engine *e, engine_event *event) {
    return event_queue_pop(&e->events, event);
}

/* ---- under the lock ---- */

static job *find(engine *e, int64_t id) {
    job *j = e->jobs;
    while (j != NULL && j->id != id)
        j = j->next;
    return j;
}

/* Return the stamps served to the least served job. A new job starts with that number, so that it
 * neither lags behind the others nor is owed their past. */
static int64_t least_served(const engine *e) {
    int64_t least = INT64_MAX;
    for (const job *j = e->jobs; j != NULL; j = j->next)
        least = j->served < least ? j->served : least;
    return least == INT64_MAX ? 0 : least;
}

static void stop(engine *e, job *j) {
    j->stop_asked = true;
    atomic_store(&j->stopping, true);
    if (j->phase == JOB_MEASURING)
        shear_work_stop(j->work);
    pthread_cond_broadcast(&e->progressed);
}

/* ---- creating and freeing ---- */

static int start_workers(engine *e, shear_error *err) {
    for (; e->n_workers < e->options.workers; e->n_workers++) {
        worker *w = &e->workers[e->n_workers];
        *w = (worker){.engine = e, .slot = e->n_workers};
        const int rc = thread_start(&w->thread, worker_main, w);
        if (rc != 0) {
            return shear_fail(err, SHEAR_E_NOMEM, "use fewer workers",
                              "cannot start %d threads: %s", e->options.workers, strerror(rc));
        }
    }
    return SHEAR_OK;
}

int engine_new(engine **out, const engine_options *options, shear_error *err) {
    CLEANUP(engine_release) engine *e = calloc(1, sizeof *e);
    *out = NULL;
    if (e == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the engine");
    e->options = *options;
    e->budget.total = options->memory_bytes;
    event_queue_init(&e->events, options->wake, options->context);
    pthread_mutex_init(&e->lock, NULL);
    pthread_cond_init(&e->progressed, NULL);
    pthread_cond_init(&e->work_available, NULL);
    e->program = strdup(options->limits.program);
    e->scratch = strdup(options->limits.scratch);
    e->workers = calloc((size_t)options->workers, sizeof *e->workers);
    e->plans = plan_cache_new(options->plans_count, options->plans_bytes);
    if (e->program == NULL || e->scratch == NULL || e->workers == NULL || e->plans == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the engine");
    engine_limit_readers(e, &options->limits);
    TRY(start_workers(e, err));
    *out = CLEANUP_TAKE(e);
    return SHEAR_OK;
}

void engine_free(engine *e) {
    if (e == NULL)
        return;
    event_queue_silence(&e->events);
    pthread_mutex_lock(&e->lock);
    e->stopping = true;
    for (job *j = e->jobs; j != NULL; j = j->next)
        stop(e, j);
    pthread_cond_broadcast(&e->work_available);
    while (e->job_threads > 0)
        pthread_cond_wait(&e->progressed, &e->lock);
    pthread_mutex_unlock(&e->lock);
    for (int i = 0; i < e->n_workers; i++)
        pthread_join(e->workers[i].thread, NULL);
    event_queue_deinit(&e->events);
    plan_cache_free(e->plans);
    pthread_mutex_destroy(&e->lock);
    pthread_cond_destroy(&e->work_available);
    pthread_cond_destroy(&e->progressed);
    free(e->program);
    free(e->scratch);
    free(e->workers);
    free(e);
}

const char *engine_get_scratch(const engine *e) {
    return e->scratch;
}

/* ---- jobs ---- */

int engine_add(engine *e, const engine_job *spec, shear_error *err) {
    job *j = job_new(spec, e);
    if (j == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a job");
    pthread_t thread;
    pthread_mutex_lock(&e->lock);
    const int rc = thread_start(&thread, job_thread_main, j); /* it waits for the lock */
    if (rc == 0) {
        j->served = least_served(e);
        j->next = e->jobs;
        e->jobs = j;
        e->job_threads++;
    }
    pthread_mutex_unlock(&e->lock);
    if (rc != 0) {
        job_free(j);
        return shear_fail(err, SHEAR_E_NOMEM, "let fewer jobs be active ([daemon] max_active_jobs)",
                          "cannot start a thread for a job: %s", strerror(rc));
    }
    return SHEAR_OK;
}

/* Return a copy, or NULL if `terms` is NULL or memory is out. */
static shear_symmetry *copy_terms(const shear_symmetry *terms) {
    CLEANUP(shear_symmetry_release) shear_symmetry *copy = NULL;
    if (terms == NULL || shear_symmetry_new(&copy, NULL) != SHEAR_OK ||
        shear_symmetry_join(copy, terms, 0, NULL) != SHEAR_OK) {
        return NULL;
    }
    return CLEANUP_TAKE(copy);
}

void engine_go(engine *e, int64_t id, const engine_checkpoint *checkpoint) {
    /* If memory is out for the checkpoint, the job starts from the beginning. */
    char *sums = checkpoint != NULL ? strdup(checkpoint->sums) : NULL;
    shear_symmetry *terms = checkpoint != NULL ? copy_terms(checkpoint->terms) : NULL;
    pthread_mutex_lock(&e->lock);
    job *j = find(e, id);
    if (j != NULL && j->phase == JOB_OPENED && !j->go) {
        j->go = true;
        j->first_block = sums != NULL ? checkpoint->next_block : 0;
        j->sums_before = sums;
        j->terms_before = terms;
        sums = NULL;
        terms = NULL;
        pthread_cond_broadcast(&e->progressed);
    }
    pthread_mutex_unlock(&e->lock);
    shear_symmetry_free(terms);
    free(sums);
}

void engine_stop_job(engine *e, int64_t id) {
    LOCKED(&e->lock);
    job *j = find(e, id);
    if (j != NULL)
        stop(e, j);
}

bool engine_get_progress(engine *e, int64_t id, engine_progress *progress) {
    LOCKED(&e->lock);
    const job *j = find(e, id);
    if (j == NULL)
        return false;
    *progress = (engine_progress){.stage = (enum engine_stage)atomic_load(&j->stage),
                                  .hashed = atomic_load(&j->hashed),
                                  .bytes = j->bytes,
                                  .total = -1};
    if (j->phase == JOB_MEASURING) {
        const shear_work_status status = shear_work_get_status(j->work);
        progress->done = status.stamps_done;
        progress->total = status.stamps_total;
    }
    return true;
}

bool engine_partial(engine *e, int64_t id, shear_field_sums *sums) {
    LOCKED(&e->lock);
    const job *j = find(e, id);
    if (j == NULL || j->phase != JOB_MEASURING)
        return false;
    if (j->before != NULL)
        shear_field_sums_join(sums, j->before);
    shear_work_join_into(j->work, sums);
    return true;
}

static int64_t blocks_left(const job *j) {
    if (j->phase != JOB_MEASURING)
        return 0;
    const shear_work_status status = shear_work_get_status(j->work);
    return (status.stamps_total - status.stamps_done + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
}

engine_load engine_get_load(engine *e) {
    LOCKED(&e->lock);
    engine_load load = {.workers = e->n_workers, .busy = e->busy, .stamps_total = e->stamps_total};
    load.memory_total = e->budget.total;
    load.memory_used = e->budget.reserved;
    for (const job *j = e->jobs; j != NULL; j = j->next) {
        load.jobs++;
        load.memory_waiting += j->waiting_since > 0 && j->stage == ENGINE_WAITING_MEMORY;
        load.blocks_left += blocks_left(j);
    }
    load.plans = plan_cache_get_statistics(e->plans);
    load.memory_used += load.plans.bytes;
    return load;
}

void engine_limit_readers(engine *e, const reader_limits *limits) {
    e->options.limits = *limits;
    e->options.limits.program = e->program;
    e->options.limits.scratch = e->scratch;
    e->options.limits.scratch_used = &e->scratch_used;
}

void engine_limit_memory(engine *e, int64_t bytes) {
    LOCKED(&e->lock);
    e->budget.total = bytes;
    pthread_cond_broadcast(&e->progressed);
}

void engine_limit_plans(engine *e, int64_t count, int64_t bytes) {
    plan_cache_limit(e->plans, count, bytes);
}
