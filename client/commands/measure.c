/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl measure: field files in, the shear of each field out. */
#include "cmdline/command.h"
#include "cmdline/options.h"
#include "cmdline/part_options.h"
#include "cmdline/settings_options.h"
#include "cmdline/settings_parse.h"
#include "local/catalog_path.h"
#include "local/measure_group.h"
#include "local/measure_input.h"
#include "local/result_text.h"
#include "sheard/report.h"
#include "terminal/message.h"
#include "terminal/progress.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_THREADS = 1024, MAX_JACKKNIFE = 100000 };
enum { OPT_THREADS = 256, OPT_CATALOG, OPT_FORCE, OPT_JACKKNIFE, OPT_FIELD, OPT_JSON, OPT_QUIET };

static const struct option own_options[] = {
    {"threads", required_argument, NULL, OPT_THREADS},
    {"catalog", required_argument, NULL, OPT_CATALOG},
    {"force", no_argument, NULL, OPT_FORCE},
    {"jackknife", required_argument, NULL, OPT_JACKKNIFE},
    {"field", required_argument, NULL, OPT_FIELD},
    {"json", no_argument, NULL, OPT_JSON},
    {"quiet", no_argument, NULL, OPT_QUIET},
    PART_OPTIONS,
};
enum { N_OWN = sizeof own_options / sizeof own_options[0] };

static int handle(int value, const char *argument, void *context) {
    measure_options *o = context;
    int64_t number = 0;
    int code = EXIT_CODE_DONE;
    if (part_options_is(value)) {
        part_options_set(&o->parts, value, argument);
        return EXIT_CODE_DONE;
    }
    switch (value) {
    case OPT_THREADS:
        code = options_int("threads", argument, 1, MAX_THREADS, &number);
        o->threads = (int)number;
        break;
    case OPT_JACKKNIFE:
        code = options_int("jackknife", argument, 2, MAX_JACKKNIFE, &number);
        o->jackknife = (int)number;
        break;
    case OPT_CATALOG:
        o->catalog = argument;
        break;
    case OPT_FIELD:
        o->field = argument;
        break;
    case OPT_FORCE:
        o->force = true;
        break;
    case OPT_JSON:
        o->json = true;
        break;
    default:
        o->quiet = true;
        break;
    }
    return code;
}

static int check_options(measure_options *o, char **files, int n_files) {
    const int code = part_options_settle(&o->parts, &cmd_measure, files, n_files);
    if (code != SHEAR_OK) {
        return code;
    }
    if (o->jackknife != 0 && o->settings.estimator != SHEAR_ESTIMATOR_MEAN) {
        message_fail("leave one of the two out", "--jackknife is for --estimator mean only");
        return EXIT_CODE_USAGE;
    }
    if (o->field != NULL && !o->field[0]) {
        message_fail(NULL, "--field: the name is empty");
        return EXIT_CODE_USAGE;
    }
    return EXIT_CODE_DONE;
}

static int parse(int argc, char **argv, measure_options *o) {
    settings_parser p = {.self = &cmd_measure,
                         .own = own_options,
                         .n_own = N_OWN,
                         .handle = handle,
                         .context = o,
                         .settings = &o->settings};
    const int code = settings_parse(&p, argc, argv);
    return code != SHEAR_OK ? code : check_options(o, argv + optind, argc - optind);
}

static int print_json(const measure_group *g, const measure_options *o) {
    shear_error err = {0};
    char *text = NULL;
    sheard_report_file *files = calloc(g->n, sizeof *files);
    if (files == NULL) {
        message_fail(NULL, "out of memory");
        return EXIT_CODE_OTHER;
    }
    sheard_report report = {
        .field = g->field,
        .result = &g->result,
        .settings = &o->settings,
        .plan = &measure_group_first(g)->report.plan,
        .files = files,
        .warnings = (const char *const *)g->warnings.text,
        .n_warnings = g->warnings.n,
        .estimators = &g->estimators,
        .seconds = g->seconds,
    };
    const measure_input *top = measure_group_top(g);
    report.top_file = top != NULL ? top->path : NULL;
    report.has_truth = measure_group_truth(g, &report.true_g1, &report.true_g2);
    for (size_t i = 0; i < g->n; i++) {
        const measure_input *input = g->inputs[i];
        if (input->measured) {
            const shear_run_report *run = &input->report;
            files[report.n_files++] = (sheard_report_file){
                input->path,        input->checksum, input->info.name, run->result.n_stamps,
                run->result.n_used, &run->plan,      run->seconds};
        }
    }
    int code = sheard_report_json(&text, &report, &err);
    if (code != SHEAR_OK) {
        message_error(&err);
    } else {
        puts(text);
    }
    free(text);
    free(files);
    return code != SHEAR_OK ? EXIT_CODE_OTHER : EXIT_CODE_DONE;
}

static int show(const measure_group *g, const measure_options *o) {
    int code = EXIT_CODE_DONE;
    if (o->json) {
        code = print_json(g, o);
    } else {
        result_text_print(g, &o->settings, stdout);
    }
    fflush(stdout); /* a field's result is out before the next one is measured */
    if (!o->quiet) {
        warnings_print(&g->warnings, g->field);
    }
    return code;
}

/* A warning for every duplicate, with the field that it would have been counted to. */
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

static int measure_groups(measure_input *inputs, size_t n, const measure_options *o) {
    measure_group *groups = NULL;
    size_t n_groups = 0;
    int shown = EXIT_CODE_DONE;
    if (!measure_groups_new(inputs, n, &groups, &n_groups)) {
        message_fail(NULL, "out of memory");
        return EXIT_CODE_OTHER;
    }
    warn_duplicates(inputs, n, groups, n_groups);
    for (size_t i = 0; i < n_groups && !progress_interrupted(); i++) {
        if (measure_group_run(&groups[i], o) && show(&groups[i], o) != 0) {
            shown = EXIT_CODE_OTHER;
        }
    }
    measure_groups_free(groups, n_groups);
    if (progress_interrupted() || shown != 0) {
        return EXIT_CODE_OTHER;
    }
    return measure_inputs_exit_code(inputs, n);
}

static int measure_inputs(const shear_input *sources, const char *const *names, size_t n,
                          const measure_options *o) {
    int code = EXIT_CODE_DONE;
    measure_input *inputs = calloc(n, sizeof *inputs);
    if (inputs == NULL) {
        message_fail(NULL, "out of memory");
        return EXIT_CODE_OTHER;
    }
    for (size_t i = 0; i < n; i++) {
        inputs[i].source = &sources[i];
        inputs[i].path = names[i];
    }
    measure_inputs_open(inputs, n, o->field);
    if (o->catalog != NULL) {
        code = catalog_paths_resolve(inputs, n, o->catalog, o->force);
    }
    if (code == SHEAR_OK) {
        code = measure_groups(inputs, n, o);
    }
    measure_inputs_free(inputs, n);
    return code;
}

static int measure_files(char **paths, size_t n, const measure_options *o) {
    shear_input *sources = calloc(n, sizeof *sources);
    if (sources == NULL) {
        message_fail(NULL, "out of memory");
        return EXIT_CODE_OTHER;
    }
    for (size_t i = 0; i < n; i++) {
        sources[i] = shear_input_of_file(paths[i]);
    }
    const int code = measure_inputs(sources, (const char *const *)paths, n, o);
    free(sources);
    return code;
}

static int measure_parts(const measure_options *o) {
    char text[SHEAR_INPUT_TEXT_SIZE];
    part_input parts;
    shear_error err = {0};
    int code = part_input_init(&parts, &o->parts, false, &err);
    if (code != SHEAR_OK) {
        message_error(&err);
        code = code == SHEAR_E_SETTING ? EXIT_CODE_USAGE : EXIT_CODE_OTHER;
    } else {
        const char *name = shear_input_text(&parts.input, text, sizeof text);
        code = measure_inputs(&parts.input, &name, 1, o);
    }
    part_input_deinit(&parts);
    return code;
}

static int run(int argc, char **argv) {
    measure_options o = {0};
    shear_settings_init(&o.settings);
    int code = parse(argc, argv, &o);
    if (code != SHEAR_OK) {
        return code;
    }
    return part_options_any(&o.parts) ? measure_parts(&o)
                                      : measure_files(argv + optind, (size_t)(argc - optind), &o);
}

const command cmd_measure = {
    .name = "measure",
    .summary = "measure the shear of field files",
    .usage =
        "usage: shearctl measure [OPTION...] FILE...\n"
        "       shearctl measure [OPTION...] FILE --catalog-in FILE[:HDU]\n"
        "       shearctl measure [OPTION...] --galaxy FILE[:HDU] --noise FILE[:HDU] --psf "
        "FILE[:HDU]\n"
        "\n"
        "Measure the shear (g1, g2) of each field. Files that name the same field (FIELD) are "
        "parts of it and\n"
        "are joined into one result.\n"
        "Where there are 200 to 1,000,000 stamps, the mean and pdf-sym are both told, and which "
        "is\n"
        "more precise.\n"
        "\n"
        "  --threads N             worker threads (default: all cores); the result does not\n"
        "                          depend on it\n"
        "  --field NAME            count all files to this one field\n"
        "  --jackknife N           errors by the jackknife over N groups of stamps (default:\n"
        "                          delta method)\n"
        "  --catalog OUT.fits      write the result of every stamp there; or into an existing\n"
        "                          directory, as DIRECTORY/BASE.shear.fits for each input\n"
        "  --force                 replace catalogs that exist\n" PART_OPTIONS_HELP
        "  --json                  one JSON object per field and line, instead of a table\n"
        "  --quiet                 no progress bar, no warnings\n"
        "\n"
        "settings:\n" COMMAND_SETTINGS_MARK "\n"
        "\n"
        "exit status: 0 done, 2 usage, 3 bad input, 4 some files failed, 1 anything else.\n",
    .run = run,
};
