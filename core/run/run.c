/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measure one field file with a team of OpenMP threads: shear_run_file(). */
#include "shear/run.h"

#include "base/cleanup.h"
#include "base/clock.h"
#include "common/release.h"
#include "run/file_source.h"
#include "run/team.h"

#include <string.h>

/* What a run owns. */
typedef struct run {
    shear_field *field;
    shear_plan *plan;
    shear_catalog *catalog;
    file_source source;
    shear_sink rows; /* the caller's */
    team_sums sums;  /* of this file; joined to the caller's at the end */
} run;

static void run_deinit(run *r) {
    file_source_deinit(&r->source);
    team_sums_deinit(&r->sums);
    shear_catalog_abort(r->catalog);
    shear_plan_free(r->plan);
    shear_field_close(r->field);
}

/* Write rows into the catalog, and hand them to the caller. */
static int write_rows(void *self, int64_t first, int count, const shear_row *rows,
                      const shear_block *block, shear_error *err) {
    const run *r = self;
    if (r->catalog != NULL)
        TRY(shear_catalog_write(r->catalog, first, count, rows, block, err));
    return r->rows.write != NULL ? r->rows.write(r->rows.self, first, count, rows, block, err)
                                 : SHEAR_OK;
}

/* Put the catalog in place. */
static int finish_catalog(run *r, const shear_input *input, const char *checksum,
                          const shear_result *result, shear_error *err) {
    char computed[SHEAR_CHECKSUM_SIZE] = "";
    char name[SHEAR_INPUT_TEXT_SIZE];
    if (checksum == NULL)
        TRY(shear_input_checksum(input, NULL, shear_field_get_info(r->field), computed, err));
    return shear_catalog_finish(CLEANUP_TAKE(r->catalog), r->plan, result,
                                shear_input_text(input, name, sizeof name),
                                checksum != NULL ? checksum : computed, err);
}

/* Measure the field. On success the report's result and the catalog are complete. */
static int run_field(run *r, const shear_input *input, const shear_settings *settings,
                     const shear_run_options *options, bool jackknife, shear_run_report *report,
                     shear_error *err) {
    const shear_field_info *info = shear_field_get_info(r->field);
    const int threads = team_threads(options->threads);
    const shear_unit_size size = shear_unit_size_for(info, threads);
    TRY(shear_plan_for_field(&r->plan, settings, r->field, err));
    if (options->catalog_path != NULL) {
        TRY(shear_catalog_create(&r->catalog, options->catalog_path, info, options->overwrite,
                                 err));
    }
    TRY(file_source_init(&r->source, r->field, threads, size.stamps, err));
    const team_job job = {.work = {.info = info,
                                   .plan = r->plan,
                                   .source = file_source_as_source(&r->source),
                                   .sink = {.self = r, .write = write_rows},
                                   .size = size,
                                   .terms = options->terms != NULL},
                          .threads = threads,
                          .jackknife = jackknife,
                          .progress = options->progress,
                          .context = options->context};
    report->plan = *shear_plan_get_info(r->plan);
    TRY(team_measure(&job, &r->sums, &report->result, err));
    return r->catalog == NULL ? SHEAR_OK
                              : finish_catalog(r, input, options->checksum, &report->result, err);
}

/* Join sums, terms and blocks to the caller's: all or none. */
static int join_caller(const team_sums *own, shear_field_sums *sums, shear_symmetry *terms,
                       shear_jackknife *jack, shear_error *err) {
    const size_t before = terms != NULL ? shear_symmetry_count(terms) : 0;
    if (terms != NULL && own->terms != NULL)
        TRY(shear_symmetry_join(terms, own->terms, 0, err));
    const int code = jack != NULL ? shear_jackknife_join(jack, own->jackknife, err) : SHEAR_OK;
    if (code == SHEAR_OK) {
        shear_field_sums_join(sums, own->sums);
    } else if (terms != NULL) {
        shear_symmetry_truncate(terms, before);
    }
    return code;
}

int shear_run_input(const shear_input *input, const shear_settings *settings,
                    const shear_run_options *options, shear_field_sums *sums, shear_jackknife *jack,
                    shear_run_report *report, shear_error *err) {
    static const shear_run_options defaults = {0};
    const shear_run_options *o = options != NULL ? options : &defaults;
    const double start = clock_s(CLOCK_MONOTONIC);
    CLEANUP(run_deinit) run r = {.rows = o->rows};
    TRY(shear_field_open_input(&r.field, input, NULL, err));
    report->field = *shear_field_get_info(r.field);
    int code = run_field(&r, input, settings, o, jack != NULL, report, err);
    code = code != SHEAR_OK ? code : join_caller(&r.sums, sums, o->terms, jack, err);
    report->seconds = clock_s(CLOCK_MONOTONIC) - start;
    if (code != SHEAR_OK && err != NULL && strstr(err->message, shear_input_name(input)) == NULL)
        shear_prefix(err, code, "file '%s'", shear_input_name(input));
    return code;
}

int shear_run_file(const char *path, const shear_settings *settings,
                   const shear_run_options *options, shear_field_sums *sums, shear_jackknife *jack,
                   shear_run_report *report, shear_error *err) {
    const shear_input input = shear_input_of_file(path);
    return shear_run_input(&input, settings, options, sums, jack, report, err);
}
