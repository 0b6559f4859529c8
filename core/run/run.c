/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One field file through a team of threads. Each thread in turn takes the next run of whole blocks: it reads their stamps
 * under the reader's lock, measures them beside the others, and hands rows and sums over under the second lock. The
 * two locks are never held together. Block sums are joined exactly, so the order of arrival does not matter. */
#include "shear/run.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Pixels (galaxy and noise) that a thread holds at a time: enough to make the lock rare, few enough to stay
 * in cache for small stamps. */
static const double pixels_at_once = 524288.0;
enum { MAX_PSFS_FOR_RADIUS = 256 };

typedef struct run {
    shear_field *field;
    const shear_field_info *info;
    const shear_plan *plan;
    const shear_run_options *options;
    shear_catalog *catalog;     /* or NULL */
    int blocks_at_once;         /* blocks in one turn */
    int stamps_at_once;         /* stamps read in one go; less than a block for large stamps */
    omp_lock_t reader;          /* guards field, next, stopped */
    int64_t next;               /* the first stamp not yet taken */
    bool stopped;
    omp_lock_t results;         /* guards all below */
    shear_field_sums *sums;
    shear_block_sums *blocks;   /* [blocks of the file] for the jackknife, or NULL */
    int64_t done;
    int64_t bad_stamp;          /* first stamp of the turn that failed first in the file */
    int code;
    shear_error error;
} run;

/* One thread's own. */
typedef struct turn {
    shear_workspace *ws;
    shear_block *block;
    shear_row *rows; /* [stamps_at_once] */
} turn;

static void fail_run(run *r, int64_t stamp, int code, const shear_error *error)
{
    omp_set_lock(&r->results);
    if (r->code == SHEAR_OK || stamp < r->bad_stamp) {
        r->code = code;
        r->bad_stamp = stamp;
        r->error = *error;
    }
    omp_unset_lock(&r->results);
    omp_set_lock(&r->reader);
    r->stopped = true;
    omp_unset_lock(&r->reader);
}

/* Take the next run of blocks: [*first, *end). False when there are none. */
static bool take_turn(run *r, int64_t *first, int64_t *end)
{
    omp_set_lock(&r->reader);
    const int64_t left = r->stopped ? 0 : r->info->n_stamps - r->next;
    const int64_t want = (int64_t)r->blocks_at_once * SHEAR_BLOCK;
    *first = r->next;
    *end = r->next + (left < want ? left : want);
    r->next = *end;
    omp_unset_lock(&r->reader);
    return left > 0;
}

static int read_stamps(run *r, turn *t, int64_t first, int count, shear_error *err)
{
    omp_set_lock(&r->reader);
    const int code = shear_field_read(r->field, first, count, t->block, err);
    omp_unset_lock(&r->reader);
    return code;
}

/* Hand over a finished block, and tell the caller how far we are. */
static int hand_over_block(run *r, int64_t index, const shear_block_sums *sums, shear_error *err)
{
    int code = SHEAR_OK;
    omp_set_lock(&r->results);
    shear_field_sums_add(r->sums, sums);
    if (r->blocks != NULL) {
        r->blocks[index] = *sums;
    }
    r->done += sums->n_stamps;
    if (r->options->progress != NULL &&
        r->options->progress(r->options->context, r->done, r->info->n_stamps) != 0) {
        code = shear_fail(err, SHEAR_E_CANCELLED, NULL, "stopped after %lld of %lld stamps",
                          (long long)r->done, (long long)r->info->n_stamps);
    }
    omp_unset_lock(&r->results);
    return code;
}

static int write_rows(run *r, const turn *t, int64_t first, int count, shear_error *err)
{
    if (r->catalog == NULL) {
        return SHEAR_OK;
    }
    omp_set_lock(&r->results);
    const int code = shear_catalog_write(r->catalog, first, count, t->rows, t->block, err);
    omp_unset_lock(&r->results);
    return code;
}

/* Stamps [first, first+count), already in rows, into the sums of their blocks; the last may stay unfinished in *open. */
static int sum_rows(run *r, const turn *t, int64_t first, int count, shear_block_sums *open, shear_error *err)
{
    int code = SHEAR_OK;
    for (int i = 0; i < count && code == SHEAR_OK; i++) {
        const int64_t stamp = first + i;
        if (stamp % SHEAR_BLOCK == 0) {
            shear_block_sums_init(open);
        }
        shear_block_sums_add(open, &t->rows[i]);
        if (stamp % SHEAR_BLOCK == SHEAR_BLOCK - 1 || stamp == r->info->n_stamps - 1) {
            code = hand_over_block(r, stamp / SHEAR_BLOCK, open, err);
        }
    }
    return code;
}

static int measure_turn(run *r, turn *t, int64_t first, int64_t end, shear_error *err)
{
    shear_block_sums open;
    shear_block_sums_init(&open);
    int code = SHEAR_OK;
    for (int64_t at = first; at < end && code == SHEAR_OK; at += r->stamps_at_once) {
        const int count = (int)(end - at < r->stamps_at_once ? end - at : r->stamps_at_once);
        code = read_stamps(r, t, at, count, err);
        if (code == SHEAR_OK) {
            code = shear_measure_range(r->plan, t->ws, &t->block->stamps, 0, count, t->rows, err);
        }
        if (code == SHEAR_OK) {
            code = write_rows(r, t, at, count, err);
        }
        if (code == SHEAR_OK) {
            code = sum_rows(r, t, at, count, &open, err);
        }
    }
    return code;
}

static int turn_init(turn *t, const run *r, shear_error *err)
{
    *t = (turn){0};
    int code = shear_workspace_new(&t->ws, r->plan, err);
    if (code == SHEAR_OK) {
        code = shear_block_new(&t->block, r->info, r->stamps_at_once, err);
    }
    t->rows = code == SHEAR_OK ? malloc((size_t)r->stamps_at_once * sizeof *t->rows) : NULL;
    if (code == SHEAR_OK && t->rows == NULL) {
        code = shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %d rows", r->stamps_at_once);
    }
    return code;
}

static void turn_deinit(turn *t)
{
    shear_workspace_free(t->ws);
    shear_block_free(t->block);
    free(t->rows);
}

static void work(run *r)
{
    turn t;
    shear_error error = {0};
    int64_t first = 0;
    int64_t end;
    int code = turn_init(&t, r, &error);
    while (code == SHEAR_OK && take_turn(r, &first, &end)) {
        code = measure_turn(r, &t, first, end, &error);
    }
    if (code != SHEAR_OK) {
        fail_run(r, first, code, &error);
    }
    turn_deinit(&t);
}

static int64_t blocks_in(int64_t stamps)
{
    return (stamps + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
}

/* How much a thread takes at a time; never more than leaves every thread something to do. */
static void size_turns(run *r, int threads)
{
    const double pair_pixels = 2.0 * r->info->geometry.nx * r->info->geometry.ny;
    const double fit = fmax(1.0, floor(pixels_at_once / pair_pixels));
    const double blocks = fmax(1.0, floor(fit / SHEAR_BLOCK));
    const double share = fmax(1.0, ceil((double)blocks_in(r->info->n_stamps) / (4.0 * threads)));
    r->blocks_at_once = (int)fmin(blocks, share);
    r->stamps_at_once = (int)fmin(fit, (double)r->blocks_at_once * SHEAR_BLOCK);
}

static int run_team(run *r)
{
    const int threads = r->options->threads > 0 ? r->options->threads : omp_get_max_threads();
    size_turns(r, threads);
    omp_init_lock(&r->reader);
    omp_init_lock(&r->results);
#pragma omp parallel num_threads(threads)
    work(r);
    omp_destroy_lock(&r->reader);
    omp_destroy_lock(&r->results);
    return r->code;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median scale radius of evenly spaced PSFs; unusable ones do not count. */
static int median_radius(shear_field *field, const shear_field_info *info, double *psf, double *r_psf,
                         shear_error *err)
{
    double radius[MAX_PSFS_FOR_RADIUS];
    int n = 0;
    const int64_t tries = info->n_psf < MAX_PSFS_FOR_RADIUS ? info->n_psf : MAX_PSFS_FOR_RADIUS;
    shear_error why = {0};
    for (int64_t i = 0; i < tries; i++) {
        const int code = shear_field_read_psf(field, i * info->n_psf / tries, psf, err);
        if (code != SHEAR_OK) {
            return code;
        }
        const shear_geometry *g = &info->geometry;
        n += shear_psf_radius(psf, g->psf_nx, g->psf_ny, g->psf_oversample, &radius[n], &why) == SHEAR_OK;
    }
    if (n == 0) {
        return shear_fail(err, SHEAR_E_PSF, why.advice, "none of %lld PSFs is usable: %s", (long long)tries,
                          why.message);
    }
    qsort(radius, (size_t)n, sizeof *radius, compare_doubles);
    *r_psf = radius[n / 2];
    return SHEAR_OK;
}

int shear_plan_for_field(shear_plan **plan, const shear_settings *settings, shear_field *field,
                         shear_error *err)
{
    const shear_field_info *info = shear_field_get_info(field);
    const bool one = info->psf_layout == SHEAR_PSF_ONE;
    const bool has_r_gal = (info->columns & SHEAR_COL_R_GAL) != 0;
    double r_psf = NAN;
    *plan = NULL;
    double *psf = malloc((size_t)info->geometry.psf_nx * (size_t)info->geometry.psf_ny * sizeof *psf);
    if (psf == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a PSF of %d x %d samples",
                          info->geometry.psf_nx, info->geometry.psf_ny);
    }
    int code = one ? shear_field_read_psf(field, 0, psf, err) : median_radius(field, info, psf, &r_psf, err);
    if (code == SHEAR_OK) {
        code = shear_plan_new(plan, settings, &info->geometry, one ? psf : NULL, r_psf, has_r_gal, err);
    }
    free(psf);
    return code;
}

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int add_to_jackknife(const run *r, shear_jackknife *jack, shear_error *err)
{
    int code = SHEAR_OK;
    for (int64_t b = 0; b < blocks_in(r->info->n_stamps) && code == SHEAR_OK; b++) {
        code = shear_jackknife_add(jack, &r->blocks[b], err);
    }
    return code;
}

/* All that the run owns besides the open field. */
static int prepare(run *r, shear_plan **plan, const shear_settings *settings, bool jackknife,
                   shear_error *err)
{
    int code = shear_plan_for_field(plan, settings, r->field, err);
    r->plan = *plan;
    if (code == SHEAR_OK) {
        code = shear_field_sums_new(&r->sums, err);
    }
    if (code == SHEAR_OK && jackknife) {
        r->blocks = calloc((size_t)blocks_in(r->info->n_stamps), sizeof *r->blocks);
        code = r->blocks != NULL ? SHEAR_OK : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the jackknife");
    }
    if (code == SHEAR_OK && r->options->catalog_path != NULL) {
        code = shear_catalog_create(&r->catalog, r->options->catalog_path, r->info, r->options->overwrite, err);
    }
    return code;
}

static int finish_catalog(run *r, const char *path, const shear_result *result, shear_error *err)
{
    char checksum[SHEAR_CHECKSUM_SIZE] = "";
    int code = SHEAR_OK;
    if (r->options->checksum == NULL) {
        code = shear_file_checksum(path, checksum, err);
    }
    if (code != SHEAR_OK) {
        shear_catalog_abort(r->catalog);
    } else {
        code = shear_catalog_finish(r->catalog, r->plan, result, path,
                                    r->options->checksum != NULL ? r->options->checksum : checksum, err);
    }
    r->catalog = NULL;
    return code;
}

/* Measure an open field; the report's result and the catalogue are complete on success. */
static int run_field(run *r, const char *path, const shear_settings *settings, shear_jackknife *jack,
                     shear_run_report *report, shear_error *err)
{
    shear_plan *plan = NULL;
    int code = prepare(r, &plan, settings, jack != NULL, err);
    if (code == SHEAR_OK && run_team(r) != SHEAR_OK) {
        code = r->code;
        if (err != NULL) {
            *err = r->error;
        }
    }
    if (code == SHEAR_OK) {
        shear_field_result(r->sums, &report->result);
        report->plan = *shear_plan_get_info(plan);
    }
    if (code == SHEAR_OK && r->catalog != NULL) {
        code = finish_catalog(r, path, &report->result, err);
    }
    if (code == SHEAR_OK && jack != NULL) {
        code = add_to_jackknife(r, jack, err);
    }
    shear_catalog_abort(r->catalog);
    free(r->blocks);
    shear_plan_free(plan);
    return code;
}

int shear_run_file(const char *path, const shear_settings *settings, const shear_run_options *options,
                   shear_field_sums *sums, shear_jackknife *jack, shear_run_report *report,
                   shear_error *err)
{
    static const shear_run_options defaults = {0};
    const double start = now_s();
    run r = {.options = options != NULL ? options : &defaults};
    int code = shear_field_open(&r.field, path, err);
    if (code != SHEAR_OK) {
        return code;
    }
    r.info = shear_field_get_info(r.field);
    report->field = *r.info;
    code = run_field(&r, path, settings, jack, report, err);
    if (code == SHEAR_OK) {
        shear_field_sums_join(sums, r.sums);
        report->seconds = now_s() - start;
    } else if (err != NULL && strstr(err->message, path) == NULL) {
        shear_prefix(err, code, "file '%s'", path);
    }
    shear_field_sums_free(r.sums);
    shear_field_close(r.field);
    return code;
}
