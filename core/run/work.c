/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Work on one field, shared by threads: claim a unit, read, measure, write, sum.
 *
 * There are four locks, and a thread never holds two of them. `reader` is held while stamps are
 * read and `sink` while rows are written, which may take long. `units` and `results` are held
 * briefly only, so that a status request or a stop never waits for a disk. */
#include "shear/work.h"

#include "base/cleanup.h"
#include "base/thread.h"
#include "common/release.h"
#include "run/reorder_buffer.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pixels_at_once =
    131072.0; /* 1 MiB, so that what was read is still in the cache */

struct shear_work {
    shear_work_spec spec;
    int64_t n_blocks;

    pthread_mutex_t reader; /* guards the source */
    pthread_mutex_t sink;   /* guards the sink */

    pthread_mutex_t units; /* guards the members up to the next lock */
    int64_t next_block;    /* the first block that has not been claimed */
    int under_way;
    bool stopped;

    pthread_mutex_t results; /* guards the members below */
    reorder_buffer summed;
    int64_t done;
    int64_t failed_at; /* first block of the failed unit that comes first in the file */
    int code;
    shear_error error;
};

struct shear_worker {
    int slot;
    shear_unit_size size;
    shear_workspace *ws;
    shear_row *rows;        /* [size.stamps] */
    shear_block_sums *sums; /* [size.blocks] of the current unit */
    shear_symmetry *terms;  /* of the current unit */
};

/* A run of blocks that one thread has claimed. */
typedef struct work_unit {
    int64_t block;
    int n;
    int64_t first, end; /* its stamps */
} work_unit;

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
    *out = NULL;
    CLEANUP(shear_work_release) shear_work *work = calloc(1, sizeof *work);
    if (work == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field's work");
    pthread_mutex_init(&work->reader, NULL);
    pthread_mutex_init(&work->sink, NULL);
    pthread_mutex_init(&work->units, NULL);
    pthread_mutex_init(&work->results, NULL);
    work->spec = *spec;
    work->n_blocks = (spec->info->n_stamps + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
    work->next_block = spec->first_block;
    work->done = spec->first_block * SHEAR_BLOCK;
    TRY(reorder_buffer_init(&work->summed, spec->first_block, wants_terms(spec), spec->jackknife,
                            err));
    *out = CLEANUP_TAKE(work);
    return SHEAR_OK;
}

void shear_work_free(shear_work *work) {
    if (work == NULL)
        return;
    reorder_buffer_deinit(&work->summed);
    pthread_mutex_destroy(&work->reader);
    pthread_mutex_destroy(&work->sink);
    pthread_mutex_destroy(&work->units);
    pthread_mutex_destroy(&work->results);
    free(work);
}

int shear_worker_new(shear_worker **out, const shear_plan *plan, shear_unit_size size, int slot,
                     shear_error *err) {
    *out = NULL;
    CLEANUP(shear_worker_release) shear_worker *worker = calloc(1, sizeof *worker);
    if (worker != NULL) {
        worker->slot = slot;
        worker->size = size;
        worker->rows = malloc((size_t)size.stamps * sizeof *worker->rows);
        worker->sums = malloc((size_t)size.blocks * sizeof *worker->sums);
    }
    if (worker == NULL || worker->rows == NULL || worker->sums == NULL ||
        shear_workspace_new(&worker->ws, plan, NULL) != SHEAR_OK) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a worker");
    }
    *out = CLEANUP_TAKE(worker);
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

static bool claim_unit(shear_work *work, work_unit *u) {
    LOCKED(&work->units);
    const int64_t left = work->stopped ? 0 : work->n_blocks - work->next_block;
    if (left <= 0)
        return false;
    u->block = work->next_block;
    u->n = left < work->spec.size.blocks ? (int)left : work->spec.size.blocks;
    u->first = u->block * SHEAR_BLOCK;
    u->end = (u->block + u->n) * SHEAR_BLOCK;
    u->end = u->end < work->spec.info->n_stamps ? u->end : work->spec.info->n_stamps;
    work->next_block += u->n;
    work->under_way++;
    return true;
}

static void release_unit(shear_work *work, bool stop) {
    LOCKED(&work->units);
    assert(work->under_way > 0);
    work->under_way--;
    work->stopped = work->stopped || stop;
}

static int read_stamps(shear_work *work, const shear_worker *worker, int64_t first, int count,
                       const shear_block **block, shear_error *err) {
    const shear_source *source = &work->spec.source;
    if (source->concurrent)
        return source->read(source->self, worker->slot, first, count, block, err);
    LOCKED(&work->reader);
    return source->read(source->self, worker->slot, first, count, block, err);
}

static int write_rows(shear_work *work, const shear_worker *worker, const shear_block *block,
                      int64_t first, int count, shear_error *err) {
    const shear_sink *sink = &work->spec.sink;
    if (sink->write == NULL)
        return SHEAR_OK;
    LOCKED(&work->sink);
    return sink->write(sink->self, first, count, worker->rows, block, err);
}

static int sum_rows(shear_worker *worker, const work_unit *u, const shear_plan *plan, int64_t first,
                    int count, shear_error *err) {
    const double beta = shear_plan_get_info(plan)->beta;
    for (int i = 0; i < count; i++) {
        shear_block_sums *b = &worker->sums[(first + i - u->first) / SHEAR_BLOCK];
        if ((first + i) % SHEAR_BLOCK == 0)
            shear_block_sums_init(b);
        shear_block_sums_add(b, &worker->rows[i]);
        if (worker->terms != NULL)
            TRY(shear_symmetry_add(worker->terms, &worker->rows[i], beta, err));
    }
    return SHEAR_OK;
}

/* Prepare empty terms for the unit, or none if this work needs none. */
static int begin_terms(const shear_work *work, shear_worker *worker, shear_error *err) {
    if (!wants_terms(&work->spec)) {
        shear_symmetry_free(worker->terms); /* from another work */
        worker->terms = NULL;
        return SHEAR_OK;
    }
    if (worker->terms == NULL)
        return shear_symmetry_new(&worker->terms, err);
    shear_symmetry_truncate(worker->terms, 0);
    return SHEAR_OK;
}

static int measure_stamps(shear_work *work, shear_worker *worker, const work_unit *u, int64_t first,
                          int count, shear_error *err) {
    const shear_block *block = NULL;
    TRY(read_stamps(work, worker, first, count, &block, err));
    TRY(shear_measure_range(work->spec.plan, worker->ws, &block->stamps, 0, count, worker->rows,
                            err));
    TRY(write_rows(work, worker, block, first, count, err));
    return sum_rows(worker, u, work->spec.plan, first, count, err);
}

static int measure_unit(shear_work *work, shear_worker *worker, const work_unit *u,
                        shear_error *err) {
    TRY(begin_terms(work, worker, err));
    for (int64_t at = u->first; at < u->end; at += worker->size.stamps) {
        const int64_t left = u->end - at;
        const int count = left < worker->size.stamps ? (int)left : worker->size.stamps;
        TRY(measure_stamps(work, worker, u, at, count, err));
    }
    return SHEAR_OK;
}

static int hand_over(shear_work *work, const shear_worker *worker, const work_unit *u,
                     shear_error *err) {
    assert(u->first < u->end && u->n <= worker->size.blocks);
    const block_result r = {
        .block = u->block, .n = u->n, .sums = worker->sums, .terms = worker->terms};
    LOCKED(&work->results);
    work->done += u->end - u->first;
    return reorder_buffer_add(&work->summed, &r, err);
}

static void record_failure(shear_work *work, const work_unit *u, int code,
                           const shear_error *error) {
    LOCKED(&work->results);
    if (work->code == SHEAR_OK || u->block < work->failed_at) {
        work->code = code;
        work->failed_at = u->block;
        work->error = *error;
    }
}

static int finish_unit(shear_work *work, shear_worker *worker, const work_unit *u,
                       shear_error *err) {
    TRY(measure_unit(work, worker, u, err));
    return hand_over(work, worker, u, err);
}

bool shear_work_step(shear_work *work, shear_worker *worker) {
    work_unit u;
    shear_error error = {0};
    if (!claim_unit(work, &u))
        return false;
    const int code = finish_unit(work, worker, &u, &error);
    if (code != SHEAR_OK)
        record_failure(work, &u, code, &error);
    release_unit(work, code != SHEAR_OK);
    return code == SHEAR_OK;
}

void shear_work_stop(shear_work *work) {
    LOCKED(&work->units);
    work->stopped = true;
}

void shear_work_fail(shear_work *work, const shear_error *err) {
    const work_unit nowhere = {.block = work->n_blocks};
    record_failure(work, &nowhere, err->code, err);
    shear_work_stop(work);
}

shear_work_status shear_work_get_status(shear_work *work) {
    shear_work_status status = {.stamps_total = work->spec.info->n_stamps};
    pthread_mutex_lock(&work->units);
    status.exhausted = work->stopped || work->next_block >= work->n_blocks;
    status.units_under_way = work->under_way;
    pthread_mutex_unlock(&work->units);
    pthread_mutex_lock(&work->results);
    status.stamps_done = work->done;
    status.next_block = work->summed.next_block;
    status.complete = work->summed.next_block >= work->n_blocks;
    status.code = work->code;
    pthread_mutex_unlock(&work->results);
    return status;
}

int shear_work_get_error(shear_work *work, shear_error *err) {
    LOCKED(&work->results);
    if (err != NULL)
        *err = work->error;
    return work->code;
}

int64_t shear_work_join_into(shear_work *work, shear_field_sums *sums) {
    LOCKED(&work->results);
    shear_field_sums_join(sums, work->summed.sums);
    return work->summed.next_block;
}

int shear_work_join_terms(shear_work *work, shear_field_sums *sums, size_t from,
                          shear_symmetry *terms, int64_t *next_block, shear_error *err) {
    const reorder_buffer *summed = &work->summed;
    LOCKED(&work->results);
    if (summed->terms != NULL)
        TRY(shear_symmetry_join(terms, summed->terms, from, err));
    shear_field_sums_join(sums, summed->sums);
    *next_block = summed->next_block;
    return SHEAR_OK;
}

int shear_work_sync(shear_work *work, int64_t next_block, shear_error *err) {
    const shear_sink *sink = &work->spec.sink;
    const int64_t rows = next_block * SHEAR_BLOCK;
    const int64_t all = work->spec.info->n_stamps;
    if (sink->sync == NULL)
        return SHEAR_OK;
    LOCKED(&work->sink);
    return sink->sync(sink->self, rows < all ? rows : all, err);
}
