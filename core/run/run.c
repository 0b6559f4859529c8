/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One field file from disk, through a team of OpenMP threads. */
#include "shear/run.h"

#include "shear/work.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* The file as a source: a block of stamps for every thread. */
typedef struct file_source {
    shear_field *field;
    shear_block **blocks; /* [threads] */
    int threads;
} file_source;

static int read_file(void *self, int slot, int64_t first, int count, const shear_block **block,
                     shear_error *err) {
    file_source *source = self;
    *block = source->blocks[slot];
    return shear_field_read(source->field, first, count, source->blocks[slot], err);
}

static int write_catalog(void *self, int64_t first, int count, const shear_row *rows,
                         const shear_block *block, shear_error *err) {
    return shear_catalog_write(self, first, count, rows, block, err);
}

static int file_source_init(file_source *source, shear_field *field, int threads, int capacity,
                            shear_error *err) {
    *source = (file_source){.field = field, .threads = threads};
    source->blocks = calloc((size_t)threads, sizeof(shear_block *));
    int code = source->blocks != NULL
                   ? SHEAR_OK
                   : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %d threads", threads);
    for (int i = 0; i < threads && code == SHEAR_OK; i++) {
        code = shear_block_new(&source->blocks[i], shear_field_get_info(field), capacity, err);
    }
    return code;
}

static void file_source_deinit(file_source *source) {
    for (int i = 0; source->blocks != NULL && i < source->threads; i++) {
        shear_block_free(source->blocks[i]);
    }
    free(source->blocks);
}

/* Tell the caller how far we are; non-zero where he wants to stop. Only one thread calls. */
static int report_progress(const shear_run_options *options, shear_work *work) {
    if (options->progress == NULL) {
        return 0;
    }
    const shear_work_status status = shear_work_get_status(work);
    return options->progress(options->context, status.stamps_done, status.stamps_total);
}

/* All threads take turns until none is left; the first of them reports. */
static int run_team(shear_work *work, const shear_plan *plan, shear_turn_size size, int threads,
                    const shear_run_options *options, shear_error *err) {
    int code = SHEAR_OK;
#pragma omp parallel num_threads(threads)
    {
        const int slot = omp_get_thread_num();
        shear_worker *worker = NULL;
        shear_error error = {0};
        int own = shear_worker_new(&worker, plan, size, slot, &error);
        while (own == SHEAR_OK && shear_work_step(work, worker)) {
            if (slot == 0 && report_progress(options, work) != 0) {
                own = shear_fail(&error, SHEAR_E_CANCELLED, NULL, "stopped by the caller");
            }
        }
        if (own != SHEAR_OK) {
            shear_work_stop(work);
#pragma omp critical(shear_run_error)
            if (code == SHEAR_OK) {
                code = own;
                if (err != NULL) {
                    *err = error;
                }
            }
        }
        shear_worker_free(worker);
    }
    if (code == SHEAR_OK && shear_work_get_status(work).code != SHEAR_OK) {
        code = shear_work_get_error(work, err);
    }
    if (code == SHEAR_OK) {
        report_progress(options, work);
    }
    return code;
}

static double now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Put the catalog in place; frees it. */
static int finish_catalog(shear_catalog *catalog, const shear_plan *plan,
                          const shear_result *result, const shear_input *input,
                          const shear_field_info *info, const shear_run_options *options,
                          shear_error *err) {
    char checksum[SHEAR_CHECKSUM_SIZE] = "";
    char name[SHEAR_INPUT_TEXT_SIZE];
    if (options->checksum == NULL) {
        const int code = shear_input_checksum(input, NULL, info, checksum, err);
        if (code != SHEAR_OK) {
            shear_catalog_abort(catalog);
            return code;
        }
    }
    return shear_catalog_finish(catalog, plan, result, shear_input_text(input, name, sizeof name),
                                options->checksum != NULL ? options->checksum : checksum, err);
}

/* What a run owns besides the open field. */
typedef struct run {
    shear_plan *plan;
    shear_catalog *catalog;
    shear_jackknife *jackknife; /* of this file, joined to the caller's at the end */
    file_source source;
    shear_work *work;
    shear_field_sums *sums;
    shear_symmetry *terms; /* or NULL; likewise joined to the caller's */
} run;

static void run_deinit(run *r) {
    shear_work_free(r->work);
    file_source_deinit(&r->source);
    shear_field_sums_free(r->sums);
    shear_symmetry_free(r->terms);
    shear_jackknife_free(r->jackknife);
    shear_catalog_abort(r->catalog);
    shear_plan_free(r->plan);
}

static int run_init(run *r, shear_field *field, const shear_settings *settings,
                    const shear_run_options *options, int threads, const shear_jackknife *jack,
                    shear_turn_size *size, shear_error *err) {
    const shear_field_info *info = shear_field_get_info(field);
    *size = shear_turn_size_for(info, threads);
    int code = shear_plan_for_field(&r->plan, settings, field, err);
    if (code == SHEAR_OK) {
        code = shear_field_sums_new(&r->sums, err);
    }
    if (code == SHEAR_OK &&
        (options->terms != NULL || shear_estimator_is_symmetric(settings->estimator))) {
        code = shear_symmetry_new(&r->terms, err);
    }
    if (code == SHEAR_OK && jack != NULL) {
        code = shear_jackknife_new(&r->jackknife, 2, err);
    }
    if (code == SHEAR_OK && options->catalog_path != NULL) {
        code =
            shear_catalog_create(&r->catalog, options->catalog_path, info, options->overwrite, err);
    }
    if (code == SHEAR_OK) {
        code = file_source_init(&r->source, field, threads, size->stamps, err);
    }
    if (code == SHEAR_OK) {
        const shear_work_spec spec = {
            .info = info,
            .plan = r->plan,
            .source = {.self = &r->source, .read = read_file},
            .size = *size,
            .sink = {.self = r->catalog, .write = r->catalog != NULL ? write_catalog : NULL},
            .jackknife = r->jackknife,
            .terms = r->terms != NULL};
        code = shear_work_new(&r->work, &spec, err);
    }
    return code;
}

/* Measure an open field; on success the report's result and the catalog are complete. */
static int run_field(run *r, const shear_input *input, shear_field *field,
                     const shear_settings *settings, const shear_run_options *options,
                     const shear_jackknife *jack, shear_run_report *report, shear_error *err) {
    const int threads = options->threads > 0 ? options->threads : omp_get_max_threads();
    shear_turn_size size;
    int code = run_init(r, field, settings, options, threads, jack, &size, err);
    if (code == SHEAR_OK) {
        code = run_team(r->work, r->plan, size, threads, options, err);
    }
    if (code == SHEAR_OK) {
        int64_t blocks;
        report->plan = *shear_plan_get_info(r->plan);
        code = shear_work_join_terms(r->work, r->sums, 0, r->terms, &blocks, err);
    }
    if (code == SHEAR_OK) {
        const int estimator = shear_plan_get_settings(r->plan)->estimator;
        code = shear_estimate(estimator, r->sums, r->terms, &report->result, err);
    }
    if (code == SHEAR_OK && r->catalog != NULL) {
        code = finish_catalog(r->catalog, r->plan, &report->result, input,
                              shear_field_get_info(field), options, err);
        r->catalog = NULL;
    }
    return code;
}

/* Terms and blocks, to the caller's: both or neither. */
static int join_caller(const run *r, shear_symmetry *terms, shear_jackknife *jack,
                       shear_error *err) {
    const size_t before = terms != NULL ? shear_symmetry_count(terms) : 0;
    int code = SHEAR_OK;
    if (terms != NULL && r->terms != NULL) {
        code = shear_symmetry_join(terms, r->terms, 0, err);
    }
    if (code == SHEAR_OK && jack != NULL) {
        code = shear_jackknife_join(jack, r->jackknife, err);
    }
    if (code != SHEAR_OK && terms != NULL) {
        shear_symmetry_truncate(terms, before);
    }
    return code;
}

/* What an error is about, where its message does not say. */
static const char *name_of(const shear_input *input) {
    return input->path != NULL ? input->path : input->parts[SHEAR_PART_GALAXY].path;
}

int shear_run_input(const shear_input *input, const shear_settings *settings,
                    const shear_run_options *options, shear_field_sums *sums, shear_jackknife *jack,
                    shear_run_report *report, shear_error *err) {
    static const shear_run_options defaults = {0};
    const double start = now_s();
    shear_field *field = NULL;
    run r = {0};
    int code = shear_field_open_input(&field, input, NULL, err);
    if (code != SHEAR_OK) {
        return code;
    }
    report->field = *shear_field_get_info(field);
    code = run_field(&r, input, field, settings, options != NULL ? options : &defaults, jack,
                     report, err);
    if (code == SHEAR_OK) {
        code = join_caller(&r, options != NULL ? options->terms : NULL, jack, err);
    }
    if (code == SHEAR_OK) {
        shear_field_sums_join(sums, r.sums);
        report->seconds = now_s() - start;
    } else if (err != NULL && strstr(err->message, name_of(input)) == NULL) {
        shear_prefix(err, code, "file '%s'", name_of(input));
    }
    run_deinit(&r);
    shear_field_close(field);
    return code;
}

int shear_run_file(const char *path, const shear_settings *settings,
                   const shear_run_options *options, shear_field_sums *sums, shear_jackknife *jack,
                   shear_run_report *report, shear_error *err) {
    const shear_input input = shear_input_of_file(path);
    return shear_run_input(&input, settings, options, sums, jack, report, err);
}
