/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl validate: check field files or an exposure, and report the content and whether it can be
 * measured. */
#include "base/cleanup.h"
#include "cmdline/part_options.h"
#include "commands/commands.h"
#include "local/chip_scan.h"
#include "local/field_scan.h"
#include "local/validation.h"
#include "local/validation_text.h"
#include "shear/run.h"
#include "sheard/advice.h"
#include "terminal/message.h"
#include "terminal/progress.h"

#include <getopt.h>

typedef struct validate_options {
    option_settings settings;
    part_options parts;
    bool json, quiet;
} validate_options;

static enum exit_code show(const sheard_validation_report *v, bool json) {
    CLEANUP(release_free) char *text = NULL;
    shear_error err = {0};
    if (!json) {
        validation_text_print(v, stdout);
        return EXIT_CODE_DONE;
    }
    if (sheard_validation_report_json(&text, v, &err) != SHEAR_OK)
        return message_error(&err);
    puts(text);
    return EXIT_CODE_DONE;
}

/* What is found in one input. */
typedef struct findings {
    const shear_input *input;
    shear_field *field;
    shear_plan *plan;
    chip_scan chips;
    warning_list warnings;
    sheard_validation_report report;
} findings;

static void findings_deinit(findings *f) {
    warnings_deinit(&f->warnings);
    chip_scan_deinit(&f->chips);
    shear_plan_free(f->plan);
    shear_field_close(f->field);
}

/* Open, plan and scan the input, as far as possible. Returns an error code, with the reason for the
 * conclusion. */
static int look_into(const validate_options *o, findings *f, shear_error *words) {
    sheard_validation_report *v = &f->report;
    TRY(shear_field_open_input(&f->field, f->input, NULL, words));
    v->field = shear_field_get_info(f->field);
    TRY(chip_scan_init(&f->chips, f->field, v, words));
    TRY(shear_plan_for_field(&f->plan, v->settings, f->field, words));
    v->plan = shear_plan_get_info(f->plan);
    progress *bar = progress_begin(v->path, o->quiet);
    int code = field_scan(f->field, f->plan, &f->chips, bar, v, words);
    progress_end(bar);
    if (code != SHEAR_OK)
        return code;
    TRY(shear_field_need_name(v->field, shear_input_name(f->input), words));
    validation_conclude(v, words);
    return SHEAR_OK;
}

/* Collect the warnings of the result, or as far as it goes. */
static void warn(findings *f) {
    sheard_validation_report *v = &f->report;
    sheard_advice_list doubts = {.n = 0};
    if (v->measured) {
        sheard_advice_all(&doubts, &v->result, v->plan, NULL);
    } else if (v->plan != NULL) {
        sheard_advice_psf(&doubts, v->plan);
    }
    for (size_t i = 0; i < doubts.n; i++)
        warnings_add(&f->warnings, "%s", doubts.lines[i]);
    chip_scan_warn(v, f->input, &f->warnings);
    v->warnings = (const char *const *)f->warnings.text;
    v->n_warnings = f->warnings.n;
}

/* Validate one input, and set *good. Returns an exit code for failures that are not the file's. */
static enum exit_code validate(const shear_input *input, const validate_options *o, bool *good) {
    char path[SHEAR_INPUT_TEXT_SIZE];
    shear_error words = {0};
    CLEANUP(findings_deinit)
    findings f = {.input = input,
                  .report = {.path = shear_input_text(input, path, sizeof path),
                             .settings = &o->settings.values}};
    const int code = look_into(o, &f, &words);
    if (code == SHEAR_E_CANCELLED || code == SHEAR_E_NOMEM || code == SHEAR_E_INTERNAL)
        return message_error(&words);
    warn(&f);
    f.report.conclusion = words.message;
    f.report.advice = words.advice;
    *good = f.report.good;
    return show(&f.report, o->json);
}

static enum exit_code parse(const command *self, int argc, char **argv, validate_options *o) {
    const option_entry options[] = {{.name = "json", .flag = &o->json},
                                    {.name = "quiet", .flag = &o->quiet},
                                    PART_OPTIONS(&o->parts),
                                    EXPOSURE_OPTIONS(&o->parts),
                                    {0}};
    TRY(options_parse(self, argc, argv, options, &o->settings));
    TRY(options_check_settings(&o->settings));
    return part_options_settle(&o->parts, self, argv + optind, argc - optind);
}

static enum exit_code validate_parts(const validate_options *o) {
    CLEANUP(part_input_deinit) part_input parts = {0};
    shear_error err = {0};
    bool good = false;
    if (part_input_init(&parts, &o->parts, false, &err) != SHEAR_OK)
        return message_error(&err);
    TRY(validate(&parts.input, o, &good));
    return good ? EXIT_CODE_DONE : EXIT_CODE_INPUT;
}

static enum exit_code run(const command *self, int argc, char **argv) {
    validate_options o = {.parts = PART_OPTIONS_INIT};
    TRY(parse(self, argc, argv, &o));
    if (part_options_any(&o.parts))
        return validate_parts(&o);
    int n_good = 0;
    for (int i = optind; i < argc; i++) {
        shear_input input = shear_input_of_file(argv[i]);
        input.mosaic = o.parts.mosaic;
        bool good = false;
        TRY(validate(&input, &o, &good));
        n_good += good;
    }
    return n_good == argc - optind ? EXIT_CODE_DONE
           : n_good == 0           ? EXIT_CODE_INPUT
                                   : EXIT_CODE_PARTLY;
}

COMMAND(validate, "tell what is in field files, and whether they would measure", run, NULL);
