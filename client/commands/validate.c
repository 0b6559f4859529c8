/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl validate: check a field file, and report its content and whether it can be measured. */
#include "base/cleanup.h"
#include "cmdline/options.h"
#include "commands/commands.h"
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
    bool json, quiet;
} validate_options;

CLEANUP_DEFINE(shear_field, shear_field_close)
CLEANUP_DEFINE(shear_plan, shear_plan_free)

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

/* Open, plan and scan the file, as far as possible. Returns an error code, with the reason for the
 * conclusion. */
static int look_into(const validate_options *o, shear_field **field, shear_plan **plan,
                     sheard_validation_report *v, shear_error *words) {
    TRY(shear_field_open(field, v->path, words));
    v->field = shear_field_get_info(*field);
    TRY(shear_plan_for_field(plan, v->settings, *field, words));
    v->plan = shear_plan_get_info(*plan);
    progress *bar = progress_begin(v->path, o->quiet);
    int code = field_scan(*field, *plan, bar, v, words);
    progress_end(bar);
    if (code != SHEAR_OK)
        return code;
    TRY(shear_field_need_name(v->field, v->path, words));
    validation_conclude(v, words);
    return SHEAR_OK;
}

/* Validate one file, and set *good. Returns an exit code for failures that are not the file's. */
static enum exit_code validate(const char *path, const validate_options *o, bool *good) {
    CLEANUP(shear_field_release) shear_field *field = NULL;
    CLEANUP(shear_plan_release) shear_plan *plan = NULL;
    shear_error words = {0};
    sheard_validation_report v = {.path = path, .settings = &o->settings.values};
    sheard_advice_list doubts = {.n = 0};
    const int code = look_into(o, &field, &plan, &v, &words);
    if (code == SHEAR_E_CANCELLED || code == SHEAR_E_NOMEM || code == SHEAR_E_INTERNAL)
        return message_error(&words);
    if (v.measured) {
        sheard_advice_all(&doubts, &v.result, v.plan, NULL);
    } else if (v.plan != NULL) {
        sheard_advice_psf(&doubts, v.plan);
    }
    v.warnings = doubts.lines;
    v.n_warnings = doubts.n;
    v.conclusion = words.message;
    v.advice = words.advice;
    *good = v.good;
    return show(&v, o->json);
}

static enum exit_code parse(const command *self, int argc, char **argv, validate_options *o) {
    const option_entry options[] = {
        {.name = "json", .flag = &o->json}, {.name = "quiet", .flag = &o->quiet}, {0}};
    TRY(options_parse(self, argc, argv, options, &o->settings));
    TRY(options_check_settings(&o->settings));
    return optind >= argc ? options_fail(self, "which files?") : EXIT_CODE_DONE;
}

static enum exit_code run(const command *self, int argc, char **argv) {
    validate_options o = {.json = false};
    TRY(parse(self, argc, argv, &o));
    int n_good = 0;
    for (int i = optind; i < argc; i++) {
        bool good = false;
        TRY(validate(argv[i], &o, &good));
        n_good += good;
    }
    return n_good == argc - optind ? EXIT_CODE_DONE
           : n_good == 0           ? EXIT_CODE_INPUT
                                   : EXIT_CODE_PARTLY;
}

COMMAND(validate, "tell what is in field files, and whether they would measure", run, NULL);
