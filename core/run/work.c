/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Four locks, never held together. `reader` is held while stamps are read and `sink` while rows are
 * written: the disk may take its time. `turns` and `results` are held for moments only, so that
 * whoever asks how the work stands, or stops it, never waits for a disk. */
#include "shear/work.h"

#include "run/reorder_buffer.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

static const double pixels_at_once = 131072.0; /* 1 MiB: what was read is still in the cache */

struct shear_work {
    shear_work_spec spec;
    int64_t n_blocks;

    pthread_mutex_t reader; /* guards the source */
    pthread_mutex_t sink;   /* guards the sink */

    pthread_mutex_t turns; /* guards all until the next lock */
    int64_t next_turn;     /* the first block that nobody has taken */
    int under_way;
    bool stopped;

    pthread_mutex_t results; /* guards all below */
    joined joined;
    int64_t done;
    int64_t failed_at; /* first block of the failed turn that comes first in the file */
    int code;
    shear_error error;
};

struct shear_worker {
    int slot;
    shear_unit_size size;
    shear_workspace *ws;
    shear_row *rows;        /* [size.stamps] */
    shear_block_sums *sums; /* [size.blocks] of the turn under way */
    shear_symmetry *terms;  /* of the turn under way */
};

/* A run of blocks that one thread has taken. */
typedef struct turn {
    int64_t block;
    int n;
    int64_t first, end; /* its stamps */
} turn;

shear_unit_size shear_unit_size_for(const shear_field_info *info, int threads) {
    const int stamps = 1 + (info->noise_planes > 1 ? info->noise_planes : 1);
    const double pair_pixels = (double)stamps * info->geometry.nx * info->geometry.ny;
    const double fit = fmax(1.0, floor(pixels_at_once / pair_pixels));
    const double blocks = fmax(1.0, floor(fit / SHEAR_BLOCK));
    const double share = fmax(1.0, ceil((double)info->n_stamps / SHEAR_BLOCK / (4.0 * threads)));
    const double taken = fmin(blocks, share);
    return (shear_unit_size){.blocks = (int)taken, .stamps = (int)fmin(fit, taken * SHEAR_BLOCK)};
}

static bool wants_terms(const shear_work_spec *spec) {
    return spec->terms ||
           shear_estimator_is_symmetric(shear_plan_get_settings(spec->plan)->estimator);
}

int shear_work_new(shear_work **out, const shear_work_spec *spec, shear_error *err) {
    shear_work *work = calloc(1, sizeof *work);
    *out = NULL;
    if (work == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field's work");
    }
    const int code =
        joined_init(&work->joined, spec->first_block, wants_terms(spec), spec->jackknife, err);
    if (code != SHEAR_OK) {
        free(work);
        return code;
    }
    work->spec = *spec;
    work->n_blocks = (spec->info->n_stamps + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
    work->next_turn = spec->first_block;
    work->done = spec->first_block * SHEAR_BLOCK;
    pthread_mutex_init(&work->reader, NULL);
    pthread_mutex_init(&work->sink, NULL);
    pthread_mutex_init(&work->turns, NULL);
    pthread_mutex_init(&work->results, NULL);
    *out = work;
    return SHEAR_OK;
}

void shear_work_free(shear_work *work) {
    if (work == NULL) {
        return;
    }
    joined_deinit(&work->joined);
    pthread_mutex_destroy(&work->reader);
    pthread_mutex_destroy(&work->sink);
    pthread_mutex_destroy(&work->turns);
    pthread_mutex_destroy(&work->results);
    free(work);
}

int shear_worker_new(shear_worker **out, const shear_plan *plan, shear_unit_size size, int slot,
                     shear_error *err) {
    shear_worker *worker = calloc(1, sizeof *worker);
    *out = NULL;
    int code = worker != NULL ? shear_workspace_new(&worker->ws, plan, err) : SHEAR_E_NOMEM;
    if (code == SHEAR_OK) {
        worker->slot = slot;
        worker->size = size;
        worker->rows = malloc((size_t)size.stamps * sizeof *worker->rows);
        worker->sums = malloc((size_t)size.blocks * sizeof *worker->sums);
        code = worker->rows != NULL && worker->sums != NULL ? SHEAR_OK : SHEAR_E_NOMEM;
    }
    if (code != SHEAR_OK) {
        shear_worker_free(worker);
        return shear_fail(err, code, NULL, "out of memory for a worker");
    }
    *out = worker;
    return SHEAR_OK;
}

int64_t shear_worker_bytes(const shear_plan *plan, shear_unit_size size) {
    return shear_workspace_bytes(plan) +
           (int64_t)((size_t)size.stamps * sizeof(shear_row) +
                     (size_t)size.blocks * sizeof(shear_block_sums) + sizeof(shear_worker));
}

void shear_worker_free(shear_worker *worker) {
    if (worker != NULL) {
        shear_workspace_free(worker->ws);
        free(worker->rows);
        free(worker->sums);
        shear_symmetry_free(worker->terms);
        free(worker);
    }
}

static bool take_turn(shear_work *work, turn *t) {
    pthread_mutex_lock(&work->turns);
    const int64_t left = work->stopped ? 0 : work->n_blocks - work->next_turn;
    const bool taken = left > 0;
    if (taken) {
        t->block = work->next_turn;
        t->n = left < work->spec.size.blocks ? (int)left : work->spec.size.blocks;
        t->first = t->block * SHEAR_BLOCK;
        t->end = (t->block + t->n) * SHEAR_BLOCK;
        t->end = t->end < work->spec.info->n_stamps ? t->end : work->spec.info->n_stamps;
        work->next_turn += t->n;
        work->under_way++;
    }
    pthread_mutex_unlock(&work->turns);
    return taken;
}

static void end_turn(shear_work *work, bool stop) {
    pthread_mutex_lock(&work->turns);
    work->under_way--;
    work->stopped = work->stopped || stop;
    pthread_mutex_unlock(&work->turns);
}

static int read_stamps(shear_work *work, const shear_worker *worker, int64_t first, int count,
                       const shear_block **block, shear_error *err) {
    const shear_source *source = &work->spec.source;
    if (source->concurrent) {
        return source->read(source->self, worker->slot, first, count, block, err);
    }
    pthread_mutex_lock(&work->reader);
    const int code = source->read(source->self, worker->slot, first, count, block, err);
    pthread_mutex_unlock(&work->reader);
    return code;
}

static int write_rows(shear_work *work, const shear_worker *worker, const shear_block *block,
                      int64_t first, int count, shear_error *err) {
    const shear_sink *sink = &work->spec.sink;
    if (sink->write == NULL) {
        return SHEAR_OK;
    }
    pthread_mutex_lock(&work->sink);
    const int code = sink->write(sink->self, first, count, worker->rows, block, err);
    pthread_mutex_unlock(&work->sink);
    return code;
}

static int sum_rows(shear_worker *worker, const turn *t, const shear_plan *plan, int64_t first,
                    int count, shear_error *err) {
    const double beta = shear_plan_get_info(plan)->beta_px;
    int code = SHEAR_OK;
    for (int i = 0; i < count && code == SHEAR_OK; i++) {
        shear_block_sums *b = &worker->sums[(first + i - t->first) / SHEAR_BLOCK];
        if ((first + i) % SHEAR_BLOCK == 0) {
            shear_block_sums_init(b);
        }
        shear_block_sums_add(b, &worker->rows[i]);
        if (worker->terms != NULL) {
            code = shear_symmetry_add(worker->terms, &worker->rows[i], beta, err);
        }
    }
    return code;
}

/* Empty terms for the turn, or none where this work wants none. */
static int begin_terms(const shear_work *work, shear_worker *worker, shear_error *err) {
    if (!wants_terms(&work->spec)) {
        shear_symmetry_free(worker->terms); /* of another work */
        worker->terms = NULL;
        return SHEAR_OK;
    }
    if (worker->terms == NULL) {
        return shear_symmetry_new(&worker->terms, err);
    }
    shear_symmetry_truncate(worker->terms, 0);
    return SHEAR_OK;
}

static int measure_turn(shear_work *work, shear_worker *worker, const turn *t, shear_error *err) {
    int code = begin_terms(work, worker, err);
    for (int64_t at = t->first; at < t->end && code == SHEAR_OK; at += worker->size.stamps) {
        const int64_t left = t->end - at;
        const int count = left < worker->size.stamps ? (int)left : worker->size.stamps;
        const shear_block *block = NULL;
        code = read_stamps(work, worker, at, count, &block, err);
        if (code == SHEAR_OK) {
            code = shear_measure_range(work->spec.plan, worker->ws, &block->stamps, 0, count,
                                       worker->rows, err);
        }
        if (code == SHEAR_OK) {
            code = write_rows(work, worker, block, at, count, err);
        }
        if (code == SHEAR_OK) {
            code = sum_rows(worker, t, work->spec.plan, at, count, err);
        }
    }
    return code;
}

static int hand_over(shear_work *work, const shear_worker *worker, const turn *t,
                     shear_error *err) {
    const finished f = {.block = t->block, .n = t->n, .sums = worker->sums, .terms = worker->terms};
    pthread_mutex_lock(&work->results);
    const int code = joined_take(&work->joined, &f, err);
    work->done += t->end - t->first;
    pthread_mutex_unlock(&work->results);
    return code;
}

static void record_failure(shear_work *work, const turn *t, int code, const shear_error *error) {
    pthread_mutex_lock(&work->results);
    if (work->code == SHEAR_OK || t->block < work->failed_at) {
        work->code = code;
        work->failed_at = t->block;
        work->error = *error;
    }
    pthread_mutex_unlock(&work->results);
}

bool shear_work_step(shear_work *work, shear_worker *worker) {
    turn t;
    if (!take_turn(work, &t)) {
        return false;
    }
    shear_error error = {0};
    int code = measure_turn(work, worker, &t, &error);
    if (code == SHEAR_OK) {
        code = hand_over(work, worker, &t, &error);
    }
    if (code != SHEAR_OK) {
        record_failure(work, &t, code, &error);
    }
    end_turn(work, code != SHEAR_OK);
    return code == SHEAR_OK;
}

void shear_work_stop(shear_work *work) {
    pthread_mutex_lock(&work->turns);
    work->stopped = true;
    pthread_mutex_unlock(&work->turns);
}

void shear_work_fail(shear_work *work, const shear_error *err) {
    const turn nowhere = {.block = work->n_blocks};
    record_failure(work, &nowhere, err->code, err);
    shear_work_stop(work);
}

shear_work_status shear_work_get_status(shear_work *work) {
    shear_work_status status = {.stamps_total = work->spec.info->n_stamps};
    pthread_mutex_lock(&work->turns);
    status.exhausted = work->stopped || work->next_turn >= work->n_blocks;
    status.units_under_way = work->under_way;
    pthread_mutex_unlock(&work->turns);
    pthread_mutex_lock(&work->results);
    status.stamps_done = work->done;
    status.next_block = work->joined.next_block;
    status.complete = work->joined.next_block >= work->n_blocks;
    status.code = work->code;
    pthread_mutex_unlock(&work->results);
    return status;
}

int shear_work_get_error(shear_work *work, shear_error *err) {
    pthread_mutex_lock(&work->results);
    const int code = work->code;
    if (err != NULL) {
        *err = work->error;
    }
    pthread_mutex_unlock(&work->results);
    return code;
}

int64_t shear_work_join_into(shear_work *work, shear_field_sums *sums) {
    pthread_mutex_lock(&work->results);
    shear_field_sums_join(sums, work->joined.sums);
    const int64_t next = work->joined.next_block;
    pthread_mutex_unlock(&work->results);
    return next;
}

int shear_work_join_terms(shear_work *work, shear_field_sums *sums, size_t from,
                          shear_symmetry *terms, int64_t *next_block, shear_error *err) {
    pthread_mutex_lock(&work->results);
    const int code = work->joined.terms != NULL
                         ? shear_symmetry_join(terms, work->joined.terms, from, err)
                         : SHEAR_OK;
    if (code == SHEAR_OK) {
        shear_field_sums_join(sums, work->joined.sums);
        *next_block = work->joined.next_block;
    }
    pthread_mutex_unlock(&work->results);
    return code;
}

int shear_work_sync(shear_work *work, int64_t next_block, shear_error *err) {
    const shear_sink *sink = &work->spec.sink;
    const int64_t rows = next_block * SHEAR_BLOCK;
    const int64_t all = work->spec.info->n_stamps;
    if (sink->sync == NULL) {
        return SHEAR_OK;
    }
    pthread_mutex_lock(&work->sink);
    const int code = sink->sync(sink->self, rows < all ? rows : all, err);
    pthread_mutex_unlock(&work->sink);
    return code;
}
