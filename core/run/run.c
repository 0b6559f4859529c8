/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One field file from disk, through a team of OpenMP threads. */
#include "shear/run.h"

#include "run/team.h"

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
    file_source source;
    team_sums sums; /* of this file, joined to the caller's at the end */
} run;

static void run_deinit(run *r) {
    file_source_deinit(&r->source);
    team_sums_deinit(&r->sums);
    shear_catalog_abort(r->catalog);
    shear_plan_free(r->plan);
}

static int run_init(run *r, shear_field *field, const shear_settings *settings,
                    const shear_run_options *options, int threads, int capacity, shear_error *err) {
    const shear_field_info *info = shear_field_get_info(field);
    int code = shear_plan_for_field(&r->plan, settings, field, err);
    if (code == SHEAR_OK && options->catalog_path != NULL) {
        code =
            shear_catalog_create(&r->catalog, options->catalog_path, info, options->overwrite, err);
    }
    return code != SHEAR_OK ? code : file_source_init(&r->source, field, threads, capacity, err);
}

/* Measure an open field; on success the report's result and the catalog are complete. */
static int run_field(run *r, const shear_input *input, shear_field *field,
                     const shear_settings *settings, const shear_run_options *options,
                     bool jackknife, shear_run_report *report, shear_error *err) {
    const shear_field_info *info = shear_field_get_info(field);
    const int threads = team_threads(options->threads);
    const shear_unit_size size = shear_unit_size_for(info, threads);
    int code = run_init(r, field, settings, options, threads, size.stamps, err);
    if (code != SHEAR_OK) {
        return code;
    }
    const team_job job = {
        .info = info,
        .plan = r->plan,
        .source = {.self = &r->source, .read = read_file},
        .sink = {.self = r->catalog, .write = r->catalog != NULL ? write_catalog : NULL},
        .size = size,
        .threads = threads,
        .jackknife = jackknife,
        .terms = options->terms != NULL,
        .progress = options->progress,
        .context = options->context};
    report->plan = *shear_plan_get_info(r->plan);
    code = team_measure(&job, &r->sums, &report->result, err);
    if (code == SHEAR_OK && r->catalog != NULL) {
        code = finish_catalog(r->catalog, r->plan, &report->result, input, info, options, err);
        r->catalog = NULL;
    }
    return code;
}

/* Terms and blocks, to the caller's: both or neither. */
static int join_caller(const team_sums *own, shear_symmetry *terms, shear_jackknife *jack,
                       shear_error *err) {
    const size_t before = terms != NULL ? shear_symmetry_count(terms) : 0;
    int code = SHEAR_OK;
    if (terms != NULL && own->terms != NULL) {
        code = shear_symmetry_join(terms, own->terms, 0, err);
    }
    if (code == SHEAR_OK && jack != NULL) {
        code = shear_jackknife_join(jack, own->jackknife, err);
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
    code = run_field(&r, input, field, settings, options != NULL ? options : &defaults,
                     jack != NULL, report, err);
    if (code == SHEAR_OK) {
        code = join_caller(&r.sums, options != NULL ? options->terms : NULL, jack, err);
    }
    if (code == SHEAR_OK) {
        shear_field_sums_join(sums, r.sums.sums);
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
