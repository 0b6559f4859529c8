/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl measure: measure field files, and print the shear of each field. */
#include "base/cleanup.h"
#include "commands/commands.h"
#include "local/catalog_path.h"
#include "local/measure_group.h"
#include "local/result_text.h"
#include "sheard/report.h"
#include "terminal/message.h"
#include "terminal/progress.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_THREADS = 1024, MAX_JACKKNIFE = 100000 };

static enum exit_code check(const command *self, measure_options *o, char **files, int n_files) {
    TRY(part_options_settle(&o->parts, self, files, n_files));
    if (o->jackknife != 0 && o->settings.values.estimator != SHEAR_ESTIMATOR_MEAN) {
        return message_fail(EXIT_CODE_USAGE, "leave one of the two out",
                            "--jackknife is for --estimator mean only");
    }
    if (o->field != NULL && o->field[0] == '\0')
        return message_fail(EXIT_CODE_USAGE, NULL, "--field: the name is empty");
    return EXIT_CODE_DONE;
}

static enum exit_code parse(const command *self, int argc, char **argv, measure_options *o) {
    const option_entry options[] = {
        {.name = "threads", .integer = &o->threads, .min = 1, .max = MAX_THREADS},
        {.name = "catalog", .text = &o->catalog},
        {.name = "force", .flag = &o->force},
        {.name = "jackknife", .integer = &o->jackknife, .min = 2, .max = MAX_JACKKNIFE},
        {.name = "field", .text = &o->field},
        {.name = "json", .flag = &o->json},
        {.name = "quiet", .flag = &o->quiet},
        PART_OPTIONS(&o->parts),
        EXPOSURE_OPTIONS(&o->parts),
        {0}};
    TRY(options_parse(self, argc, argv, options, &o->settings));
    TRY(options_check_settings(&o->settings));
    return check(self, o, argv + optind, argc - optind);
}

/* Write the report of a measured group as JSON into *text, to be freed by the caller. */
static enum exit_code make_report(char **text, const measure_group *g, const measure_options *o) {
    shear_error err = {0};
    const measure_input *top = measure_group_top(g);
    sheard_report report = {
        .field = g->field,
        .result = &g->result,
        .settings = &o->settings.values,
        .plan = &measure_group_first(g)->report.plan,
        .files = g->files,
        .n_files = g->n_measured,
        .warnings = (const char *const *)g->warnings.text,
        .n_warnings = g->warnings.n,
        .estimators = &g->estimators,
        .seconds = g->seconds,
        .top_file = top != NULL ? top->path : NULL,
    };
    report.has_truth = measure_group_truth(g, &report.true_g1, &report.true_g2);
    return sheard_report_json(text, &report, &err) != SHEAR_OK ? message_error(&err)
                                                               : EXIT_CODE_DONE;
}

static enum exit_code show(const measure_group *g, const measure_options *o) {
    CLEANUP(release_free) char *report = NULL;
    TRY(make_report(&report, g, o));
    if (o->json) {
        puts(report);
    } else {
        result_text_print(g, report, stdout);
    }
    fflush(stdout); /* write a field's result before the next field is measured */
    if (!o->quiet)
        warnings_print(&g->warnings, g->field);
    return EXIT_CODE_DONE;
}

/* Warn of every duplicate, with the field that it belongs to. */
static void warn_duplicates(measure_input *inputs, size_t n, measure_group *groups,
                            size_t n_groups) {
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; inputs[i].duplicate && k < n_groups; k++) {
            if (strcmp(groups[k].field, inputs[i].field) == 0) {
                warnings_add(&groups[k].warnings,
                             "%s holds the same bytes as another file of this field: counted once",
                             inputs[i].path);
            }
        }
    }
}

static enum exit_code measure_groups(measure_input *inputs, size_t n, const measure_options *o) {
    measure_group *groups = NULL;
    size_t n_groups = 0;
    enum exit_code shown = EXIT_CODE_DONE;
    if (!measure_groups_new(inputs, n, &groups, &n_groups))
        return message_no_memory();
    warn_duplicates(inputs, n, groups, n_groups);
    for (size_t i = 0; i < n_groups && !progress_interrupted(); i++) {
        if (measure_group_run(&groups[i], o) && show(&groups[i], o) != EXIT_CODE_DONE)
            shown = EXIT_CODE_OTHER;
    }
    measure_groups_free(groups, n_groups);
    return progress_interrupted() || shown != EXIT_CODE_DONE ? EXIT_CODE_OTHER
                                                             : measure_inputs_exit_code(inputs, n);
}

static enum exit_code measure_inputs(measure_input *inputs, size_t n, const measure_options *o) {
    enum exit_code code = EXIT_CODE_DONE;
    measure_inputs_open(inputs, n, o->field);
    if (o->catalog != NULL)
        code = catalog_paths_resolve(inputs, n, o->catalog, o->force);
    if (code == EXIT_CODE_DONE)
        code = measure_groups(inputs, n, o);
    for (size_t i = 0; i < n; i++) {
        free(inputs[i].catalog);
        warnings_deinit(&inputs[i].warnings);
        chip_counts_deinit(&inputs[i].counts);
    }
    return code;
}

static enum exit_code measure_files(char **paths, size_t n, const measure_options *o) {
    CLEANUP(release_free) measure_input *inputs = calloc(n, sizeof *inputs);
    if (inputs == NULL)
        return message_no_memory();
    for (size_t i = 0; i < n; i++) {
        inputs[i] = (measure_input){.source = shear_input_of_file(paths[i]), .path = paths[i]};
        inputs[i].source.mosaic = o->parts.mosaic;
    }
    return measure_inputs(inputs, n, o);
}

static enum exit_code measure_parts(const measure_options *o) {
    char text[SHEAR_INPUT_TEXT_SIZE];
    CLEANUP(part_input_deinit) part_input parts = {0};
    shear_error err = {0};
    if (part_input_init(&parts, &o->parts, false, &err) != SHEAR_OK)
        return message_error(&err);
    measure_input input = {.source = parts.input,
                           .path = shear_input_text(&parts.input, text, sizeof text)};
    return measure_inputs(&input, 1, o);
}

static enum exit_code run(const command *self, int argc, char **argv) {
    measure_options o = {.parts = PART_OPTIONS_INIT};
    TRY(parse(self, argc, argv, &o));
    return part_options_any(&o.parts) ? measure_parts(&o)
                                      : measure_files(argv + optind, (size_t)(argc - optind), &o);
}

COMMAND(measure, "measure the shear of field files", run, NULL);
