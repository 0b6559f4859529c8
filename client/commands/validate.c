/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl validate: is this a good field file, what is in it, would it measure? */
#include "cmdline/command.h"
#include "cmdline/options.h"
#include "cmdline/settings_options.h"
#include "cmdline/settings_parse.h"
#include "local/field_scan.h"
#include "local/validation_text.h"
#include "shear/run.h"
#include "sheard/advice.h"
#include "sheard/no_shear.h"
#include "sheard/report.h"
#include "sheard/validation_report.h"
#include "terminal/message.h"
#include "terminal/progress.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

enum { OPT_JSON = 256, OPT_QUIET };

static const struct option own_options[] = {
    {"json", no_argument, NULL, OPT_JSON},
    {"quiet", no_argument, NULL, OPT_QUIET},
};
enum { N_OWN = sizeof own_options / sizeof own_options[0] };

typedef struct validate_options {
    shear_settings settings;
    bool json, quiet;
} validate_options;

static int handle(int value, const char *argument, void *context) {
    validate_options *o = context;
    (void)argument;
    if (value == OPT_JSON) {
        o->json = true;
    } else {
        o->quiet = true;
    }
    return EXIT_CODE_DONE;
}

static int parse(int argc, char **argv, validate_options *o) {
    settings_parser p = {.self = &cmd_validate,
                         .own = own_options,
                         .n_own = N_OWN,
                         .handle = handle,
                         .context = o,
                         .settings = &o->settings};
    const int code = settings_parse(&p, argc, argv);
    if (code == SHEAR_OK && optind >= argc) {
        message_fail("\"shearctl help validate\"", "validate: which files?");
        return EXIT_CODE_USAGE;
    }
    return code;
}

/* A number of two digits a little above -lowest > 0: a pedestal that is easy to type and leaves no
 * pixel at zero. */
static double pedestal_above(double lowest) {
    double x = 1.01 * -lowest;
    double unit = pow(10.0, floor(log10(x)) - 1.0);
    return ceil(x / unit) * unit;
}

/* A background that the filter would cut an edge into: its mean is beyond doubt, and no small part
 * of what a pixel scatters. */
static bool has_background(const sheard_validation_report *v) {
    static const double sigma = 4.0;
    static const double part = 0.1;
    return v->plan->filter != SHEAR_FILTER_NONE && shear_settings_keep_background(v->settings) &&
           fabs(v->noise_mean) > sigma * v->noise_mean_err &&
           fabs(v->noise_mean) > part * v->noise_rms;
}

static const char subtract_background[] =
    "the noise stamps have a mean, a background that the filter would cut an edge into: give "
    "--background noise-mean";

/* What to do about a file that would measure. */
static const char *advice_for(const sheard_validation_report *v) {
    if (has_background(v)) {
        return subtract_background;
    }
    return v->weight_is_suspect
               ? "weights made of the stamps' own flux bias the shear by several per cent: take "
                 "weights of something else, or none, and --estimator pdf-sym"
               : NULL;
}

/* The verdict on a file whose every stamp has been seen; the words go to *words. */
static void judge(sheard_validation_report *v, shear_error *words) {
    int64_t n = v->field->n_stamps;
    sheard_cause cause;
    if (v->negative.count > 0) {
        char advice[200];
        snprintf(
            advice, sizeof advice,
            "give --pedestal %.3g or more, or a method without logarithm (--interpolation none)",
            pedestal_above(v->lowest_pixel));
        shear_fail(words, SHEAR_E_NEGATIVE, advice,
                   "%s cannot take negative pixels: %" PRId64 " of %" PRId64
                   " stamps have some, down to %.6g",
                   shear_interpolation_name(v->plan->interpolation), v->negative.count, n,
                   v->lowest_pixel);
    } else if (v->n_measurable < 2) {
        shear_fail(words, SHEAR_E_FORMAT, "a field's shear needs two usable stamps at least",
                   "only %" PRId64 " of %" PRId64 " stamps could be measured", v->n_measurable, n);
    } else if (v->measured && sheard_cause_of(&v->result, v->plan, &cause)) {
        shear_fail(words, SHEAR_E_FORMAT, cause.advice, "%s: %s", cause.words,
                   v->result.valid ? "the shear is biased" : "no shear could be measured");
    } else if (v->measured && !v->result.valid) {
        char text[400];
        char advice[400];
        sheard_no_shear_advice(&v->result, advice, sizeof advice);
        shear_fail(words, SHEAR_E_FORMAT, has_background(v) ? subtract_background : advice,
                   "%s: no shear could be measured",
                   sheard_no_shear_text(&v->result, text, sizeof text));
    } else {
        v->good = true;
        shear_fail(words, SHEAR_OK, advice_for(v),
                   "would measure %" PRId64 " of %" PRId64 " stamps", v->n_measurable, n);
    }
}

static int show(const sheard_validation_report *v, bool json) {
    char *text = NULL;
    shear_error err = {0};
    if (!json) {
        validation_text_print(v, stdout);
        return EXIT_CODE_DONE;
    }
    if (sheard_validation_report_json(&text, v, &err) != 0) {
        message_error(&err);
        return EXIT_CODE_OTHER;
    }
    puts(text);
    free(text);
    return EXIT_CODE_DONE;
}

/* Open, plan, scan: as far as it goes. Returns an error code, with words for the verdict. */
static int look_into(const validate_options *o, shear_field **field, shear_plan **plan,
                     sheard_validation_report *v, shear_error *words) {
    int code = shear_field_open(field, v->path, words);
    if (code != SHEAR_OK) {
        return code;
    }
    v->field = shear_field_get_info(*field);
    code = shear_plan_for_field(plan, &o->settings, *field, words);
    if (code != SHEAR_OK) {
        return code;
    }
    v->plan = shear_plan_get_info(*plan);
    progress *bar = o->quiet ? progress_begin_quiet() : progress_begin(v->path);
    code = field_scan(*field, *plan, bar, v, words);
    progress_end(bar);
    return code != SHEAR_OK ? code : shear_field_need_name(v->field, v->path, words);
}

/* One file; *good says how it fared. Returns an exit code for what is not the file's fault. */
static int validate(const char *path, const validate_options *o, bool *good) {
    shear_field *field = NULL;
    shear_plan *plan = NULL;
    shear_error words = {0};
    sheard_validation_report v = {.path = path, .settings = &o->settings};
    sheard_advice_list doubts = {.n = 0};
    int code = look_into(o, &field, &plan, &v, &words);
    int result = EXIT_CODE_OTHER;
    if (code == SHEAR_E_CANCELLED || code == SHEAR_E_NOMEM || code == SHEAR_E_INTERNAL) {
        message_error(&words);
        goto done;
    }
    if (code == SHEAR_OK) {
        judge(&v, &words);
    }
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
    result = show(&v, o->json);
done:
    shear_plan_free(plan);
    shear_field_close(field);
    return result;
}

static int run(int argc, char **argv) {
    validate_options o = {0};
    shear_settings_init(&o.settings);
    int code = parse(argc, argv, &o);
    if (code != SHEAR_OK) {
        return code;
    }
    int n_good = 0;
    int n_bad = 0;
    for (int i = optind; i < argc; i++) {
        bool good = false;
        code = validate(argv[i], &o, &good);
        if (code != SHEAR_OK) {
            return code;
        }
        n_good += good;
        n_bad += !good;
    }
    return n_bad == 0 ? EXIT_CODE_DONE : n_good == 0 ? EXIT_CODE_INPUT : EXIT_CODE_PARTLY;
}

const command cmd_validate = {
    .name = "validate",
    .summary = "tell what is in field files, and whether they would measure",
    .usage =
        "usage: shearctl validate [OPTION...] FILE...\n"
        "\n"
        "Tell what is in each field file, how it would be measured with these settings, which "
        "stamps would be\n"
        "left out and why. Stamps count from 0.\n"
        "\n"
        "  --json                  one JSON object per file and line, instead of words\n"
        "  --quiet                 no progress bar\n"
        "\n"
        "settings:\n" COMMAND_SETTINGS_MARK "\n"
        "\n"
        "exit status: 0 all files are good, 2 usage, 3 all are bad, 4 some are, 1 anything else.\n",
    .run = run,
};
