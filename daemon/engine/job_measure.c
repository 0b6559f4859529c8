/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measure a job: resume it from a checkpoint, and do one unit of its work. */
#include "base/clock.h"

#include "base/cleanup.h"
#include "engine/internal.h"

static int write_rows(void *self, int64_t first, int count, const shear_row *rows,
                      const shear_block *block, shear_error *err) {
    return shear_catalog_write(self, first, count, rows, block, err);
}

static int sync_rows(void *self, int64_t rows, shear_error *err) {
    return shear_catalog_sync(self, rows, err);
}

/* Open the catalog, which must have the rows before the checkpoint. If it does not, *first_block
 * becomes 0, and the job starts from the beginning. */
static int open_catalog(job *j, int64_t *first_block, shear_error *err) {
    const shear_field_info *info = reader_get_info(j->reader);
    const int64_t rows = *first_block * SHEAR_BLOCK;
    if (j->catalog_path == NULL)
        return SHEAR_OK;
    if (*first_block > 0 &&
        shear_catalog_resume(&j->catalog, j->catalog_path, info, j->checksum,
                             rows < info->n_stamps ? rows : info->n_stamps, err) == SHEAR_OK) {
        return SHEAR_OK;
    }
    *first_block = 0;
    return shear_catalog_begin(&j->catalog, j->catalog_path, info, j->checksum, err);
}

/* Count a worker that begins to read. Its first read was counted when it entered the job. */
static void count_reader(job *j, int slot) {
    LOCKED(&j->engine->lock);
    j->reading += !j->seats[slot].entering;
    j->seats[slot].entering = false;
}

static void discount_reader(job *j) {
    LOCKED(&j->engine->lock);
    assert(j->reading > 0);
    j->reading--;
    job_call_workers(j);
}

static int read_block(void *self, int slot, int64_t first, int count, const shear_block **block,
                      shear_error *err) {
    job *j = self;
    count_reader(j, slot);
    const int code = reader_read(j->reader, slot, first, count, block, err);
    discount_reader(j);
    return code;
}

/* Parse the checkpoint's sums. If the terms of the same stamps are missing, *first_block becomes 0,
 * and the job starts from the beginning. */
static int read_sums_before(job *j, int64_t *first_block, shear_error *err) {
    shear_result r;
    *first_block = 0;
    if (j->first_block == 0)
        return SHEAR_OK;
    TRY(shear_field_sums_parse(&j->before, j->sums_before, err));
    shear_field_result(j->before, &r);
    const bool whole =
        j->terms_before != NULL && (int64_t)shear_symmetry_count(j->terms_before) == r.n_used;
    *first_block =
        whole || !shear_estimator_is_symmetric(j->settings.estimator) ? j->first_block : 0;
    return SHEAR_OK;
}

static void forget_before(job *j) {
    shear_field_sums_free(j->before);
    shear_symmetry_free(j->terms_before);
    j->before = NULL;
    j->terms_before = NULL;
}

/* Load the checkpoint and open the catalog. *first_block is where the work begins. */
static int resume(job *j, int64_t *first_block, shear_error *err) {
    TRY(read_sums_before(j, first_block, err));
    return open_catalog(j, first_block, err);
}

int job_begin(job *j, shear_error *err) {
    int64_t first_block = 0;
    const int code = resume(j, &first_block, err);
    if (first_block == 0)
        forget_before(j);
    j->checkpoint_block = j->terms_block = first_block;
    j->checkpoint_ms = clock_ms(CLOCK_MONOTONIC);
    if (code != SHEAR_OK)
        return code;
    const shear_work_spec spec = {.info = reader_get_info(j->reader),
                                  .plan = j->plan,
                                  .source = {.self = j, .read = read_block},
                                  .size = j->size,
                                  .first_block = first_block,
                                  .sink = {.self = j->catalog,
                                           .write = j->catalog != NULL ? write_rows : NULL,
                                           .sync = j->catalog != NULL ? sync_rows : NULL}};
    return shear_work_new(&j->work, &spec, err);
}

bool job_step(job *j, int slot, shear_error *err) {
    shear_worker **w = &j->seats[slot].worker;
    if (*w == NULL && shear_worker_new(w, j->plan, j->size, slot, err) != SHEAR_OK) {
        shear_work_fail(j->work, err);
        return false;
    }
    return shear_work_step(j->work, *w);
}
