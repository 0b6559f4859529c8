/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One lock guards the list of jobs, their phases and the events. It is never held while a job is
 * worked on; a thread that works on a job has counted itself into job->holders, and nobody frees a
 * job that is held. */
#include "engine/engine.h"

#include "engine/job.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct queued_event {
    struct queued_event *next;
    engine_event event;
} queued_event;

struct engine {
    engine_options options;
    char *program, *scratch;
    pthread_t *threads;
    int n_threads;

    pthread_mutex_t lock;
    pthread_cond_t work_there; /* a job may have something to do, or `ending` */
    bool ending;
    job *jobs;
    plans *plans; /* has a lock of its own */
    queued_event *first, **last;
    int busy;
    int64_t stamps_total;
};

typedef struct thread_start {
    engine *e;
    int slot;
} thread_start;

/* ---- events ---- */

void engine_event_deinit(engine_event *event) {
    free(event->sums);
    event->sums = NULL;
}

/* Queue an event. Where memory is out there is nothing better than to wait for some: events must
 * not be lost. */
static void emit(engine *e, engine_event *event) {
    queued_event *q = malloc(sizeof *q);
    while (q == NULL) {
        usleep(10000);
        q = malloc(sizeof *q);
    }
    q->event = *event;
    q->next = NULL;
    pthread_mutex_lock(&e->lock);
    *e->last = q;
    e->last = &q->next;
    pthread_mutex_unlock(&e->lock);
    e->options.wake(e->options.context);
}

bool engine_next_event(engine *e, engine_event *event) {
    pthread_mutex_lock(&e->lock);
    queued_event *q = e->first;
    if (q != NULL) {
        e->first = q->next;
        if (e->first == NULL) {
            e->last = &e->first;
        }
    }
    pthread_mutex_unlock(&e->lock);
    if (q == NULL) {
        return false;
    }
    *event = q->event;
    free(q);
    return true;
}

/* ---- under the lock ---- */

static job *find(engine *e, int64_t id) {
    job *j = e->jobs;
    while (j != NULL && j->id != id) {
        j = j->next;
    }
    return j;
}

static void unlink_job(engine *e, job *j) {
    job **at = &e->jobs;
    while (*at != j) {
        at = &(*at)->next;
    }
    *at = j->next;
}

/* Whether a worker could do something for the job: prepare it, take a turn, or finish it. */
static bool wants_worker(const job *j) {
    switch (j->phase) {
    case JOB_NEW:
        return true;
    case JOB_OPENED:
        return j->stop_asked && j->holders == 0;
    case JOB_MEASURING: {
        const shear_work_status status = shear_work_get_status(j->work);
        return status.exhausted ? j->holders == 0 : true;
    }
    default:
        return false;
    }
}

/* The job to serve next: highest priority, then the one that was served least. */
static job *choose(engine *e) {
    job *best = NULL;
    for (job *j = e->jobs; j != NULL; j = j->next) {
        if (wants_worker(j) && (best == NULL || j->priority > best->priority ||
                                (j->priority == best->priority && j->served < best->served))) {
            best = j;
        }
    }
    return best;
}

/* A job that comes new starts level with the least served of the others: it is neither behind nor
 * owed their past. */
static int64_t least_served(const engine *e) {
    int64_t least = INT64_MAX;
    for (const job *j = e->jobs; j != NULL; j = j->next) {
        least = j->served < least ? j->served : least;
    }
    return least == INT64_MAX ? 0 : least;
}

/* ---- what a worker does ---- */

static void end_job(engine *e, job *j, engine_event *event) {
    pthread_mutex_lock(&e->lock);
    unlink_job(e, j);
    pthread_mutex_unlock(&e->lock);
    job_free(j);
    emit(e, event);
}

static void prepare(engine *e, job *j) {
    engine_event event;
    job_prepare(j, &event);
    if (event.kind == ENGINE_FAILED) {
        end_job(e, j, &event);
        return;
    }
    pthread_mutex_lock(&e->lock);
    j->phase = JOB_OPENED;
    pthread_mutex_unlock(&e->lock);
    emit(e, &event);
}

/* Save the sums where something new has been joined. */
static void save(engine *e, job *j) {
    engine_event event = {.kind = ENGINE_CHECKPOINT, .job = j->id};
    shear_error ignored;
    if (job_checkpoint(j, &event.next_block, &event.sums, &ignored) == SHEAR_OK) {
        emit(e, &event);
    }
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

static void measure(engine *e, job *j, int slot) {
    shear_error err;
    job_step(j, slot, &err);
    if (checkpoint_due(e, j)) {
        save(e, j);
    }
}

static void finish(engine *e, job *j) {
    engine_event event;
    if (j->work == NULL) { /* stopped before it began */
        event = (engine_event){.kind = ENGINE_STOPPED, .job = j->id};
    } else {
        job_finish(j, &event);
        if (event.kind == ENGINE_STOPPED) {
            save(e, j);
        }
    }
    end_job(e, j, &event);
}

/* Whether a job that is being measured has more for this worker than its end. Turns are taken
 * without the lock: one that was there when the job was chosen may be gone by now, so what counts
 * for the end is that nobody holds the job, under the lock. */
static bool may_measure(const job *j) {
    return j->phase == JOB_MEASURING &&
           (j->holders > 0 || !shear_work_get_status(j->work).exhausted);
}

/* Serve a job once; the lock is held on entry and on return. */
static void serve(engine *e, job *j, int slot) {
    const bool measuring = may_measure(j);
    const bool preparing = j->phase == JOB_NEW;
    const int64_t turn = (int64_t)j->size.blocks * SHEAR_BLOCK;
    j->phase = preparing ? JOB_PREPARING : measuring ? JOB_MEASURING : JOB_FINISHING;
    j->served += measuring ? turn : 0;
    j->holders += measuring;
    e->busy++;
    pthread_mutex_unlock(&e->lock);
    if (preparing) {
        prepare(e, j);
    } else if (measuring) {
        measure(e, j, slot);
    } else {
        finish(e, j);
    }
    pthread_mutex_lock(&e->lock);
    e->busy--;
    if (measuring) {
        e->stamps_total += turn;
        j->holders--;
    }
    pthread_cond_broadcast(&e->work_there); /* the job may be in a new phase, or free to finish */
}

static void *worker_main(void *argument) {
    thread_start start = *(thread_start *)argument;
    free(argument);
    engine *e = start.e;
    pthread_mutex_lock(&e->lock);
    while (!e->ending) {
        job *j = choose(e);
        if (j != NULL) {
            serve(e, j, start.slot);
        } else {
            pthread_cond_wait(&e->work_there, &e->lock);
        }
    }
    pthread_mutex_unlock(&e->lock);
    return NULL;
}

/* ---- the owner's calls ---- */

static int start_threads(engine *e, shear_error *err) {
    /* Signals are the loop's. */
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int rc = 0;
    for (int i = 0; i < e->options.workers && rc == 0; i++) {
        thread_start *start = malloc(sizeof *start);
        if (start == NULL) {
            rc = ENOMEM;
            break;
        }
        *start = (thread_start){.e = e, .slot = i};
        rc = pthread_create(&e->threads[i], NULL, worker_main, start);
        if (rc == 0) {
            e->n_threads++;
        } else {
            free(start);
        }
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return rc == 0 ? SHEAR_OK
                   : shear_fail(err, SHEAR_E_NOMEM, "use fewer workers",
                                "cannot start %d threads: %s", e->options.workers, strerror(rc));
}

int engine_new(engine **out, const engine_options *options, shear_error *err) {
    engine *e = calloc(1, sizeof *e);
    *out = NULL;
    if (e == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the engine");
    }
    e->options = *options;
    e->last = &e->first;
    pthread_mutex_init(&e->lock, NULL);
    pthread_cond_init(&e->work_there, NULL);
    e->program = strdup(options->limits.program);
    e->scratch = strdup(options->limits.scratch);
    e->threads = calloc((size_t)options->workers, sizeof(pthread_t));
    e->plans = plans_new(options->plans_count, options->plans_bytes);
    int code = e->program != NULL && e->scratch != NULL && e->threads != NULL && e->plans != NULL
                   ? SHEAR_OK
                   : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the engine");
    if (code == SHEAR_OK) {
        e->options.limits.program = e->program;
        e->options.limits.scratch = e->scratch;
        code = start_threads(e, err);
    }
    if (code != SHEAR_OK) {
        engine_free(e);
        return code;
    }
    *out = e;
    return SHEAR_OK;
}

void engine_free(engine *e) {
    if (e == NULL) {
        return;
    }
    pthread_mutex_lock(&e->lock);
    e->ending = true;
    pthread_cond_broadcast(&e->work_there);
    pthread_mutex_unlock(&e->lock);
    for (int i = 0; i < e->n_threads; i++) {
        pthread_join(e->threads[i], NULL);
    }
    while (e->jobs != NULL) {
        job *j = e->jobs;
        e->jobs = j->next;
        job_free(j);
    }
    engine_event event;
    while (engine_next_event(e, &event)) {
        engine_event_deinit(&event);
    }
    plans_free(e->plans);
    pthread_mutex_destroy(&e->lock);
    pthread_cond_destroy(&e->work_there);
    free(e->program);
    free(e->scratch);
    free(e->threads);
    free(e);
}

int engine_add(engine *e, const engine_job *spec, shear_error *err) {
    job *j = job_new(spec, &e->options, e->plans);
    if (j == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a job");
    }
    pthread_mutex_lock(&e->lock);
    j->served = least_served(e);
    j->next = e->jobs;
    e->jobs = j;
    pthread_cond_signal(&e->work_there);
    pthread_mutex_unlock(&e->lock);
    return SHEAR_OK;
}

int64_t engine_go(engine *e, int64_t id, const engine_checkpoint *checkpoint) {
    pthread_mutex_lock(&e->lock);
    job *j = find(e, id);
    const bool ready = j != NULL && j->phase == JOB_OPENED && !j->stop_asked;
    if (ready) {
        j->phase = JOB_PREPARING; /* nobody touches it meanwhile */
    }
    pthread_mutex_unlock(&e->lock);
    if (!ready) {
        return 0;
    }
    engine_event event = {.kind = ENGINE_FAILED, .job = id};
    if (job_begin(j, checkpoint, &event.error) != SHEAR_OK) {
        end_job(e, j, &event);
        return 0;
    }
    const int64_t first_block = j->checkpoint_block;
    pthread_mutex_lock(&e->lock);
    j->phase = JOB_MEASURING;
    if (j->stop_asked) {
        shear_work_stop(j->work);
    }
    pthread_cond_broadcast(&e->work_there);
    pthread_mutex_unlock(&e->lock);
    return first_block;
}

void engine_stop_job(engine *e, int64_t id) {
    pthread_mutex_lock(&e->lock);
    job *j = find(e, id);
    if (j != NULL) {
        j->stop_asked = true;
        if (j->phase == JOB_MEASURING) {
            shear_work_stop(j->work);
        }
        pthread_cond_broadcast(&e->work_there);
    }
    pthread_mutex_unlock(&e->lock);
}

bool engine_progress(engine *e, int64_t id, int64_t *done, int64_t *total) {
    pthread_mutex_lock(&e->lock);
    job *j = find(e, id);
    const bool known = j != NULL && j->phase == JOB_MEASURING;
    if (known) {
        const shear_work_status status = shear_work_get_status(j->work);
        *done = status.stamps_done;
        *total = status.stamps_total;
    }
    pthread_mutex_unlock(&e->lock);
    return known;
}

bool engine_partial(engine *e, int64_t id, shear_field_sums *sums) {
    pthread_mutex_lock(&e->lock);
    job *j = find(e, id);
    const bool known = j != NULL && j->phase == JOB_MEASURING;
    if (known) {
        if (j->before != NULL) {
            shear_field_sums_join(sums, j->before);
        }
        shear_work_join_into(j->work, sums);
    }
    pthread_mutex_unlock(&e->lock);
    return known;
}

static int64_t blocks_left(const job *j) {
    if (j->phase != JOB_MEASURING) {
        return 0;
    }
    const shear_work_status status = shear_work_get_status(j->work);
    return (status.stamps_total - status.stamps_done + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
}

engine_load engine_get_load(engine *e) {
    pthread_mutex_lock(&e->lock);
    engine_load load = {.workers = e->n_threads, .busy = e->busy, .stamps_total = e->stamps_total};
    for (const job *j = e->jobs; j != NULL; j = j->next) {
        load.jobs++;
        load.blocks_left += blocks_left(j);
    }
    pthread_mutex_unlock(&e->lock);
    load.plans = plans_get_statistics(e->plans);
    return load;
}

void engine_limit_plans(engine *e, int64_t count, int64_t bytes) {
    plans_limit(e->plans, count, bytes);
}
