/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/options.h"

#include "engine/experiment.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_THREADS = 1024, MAX_GROUPS = 100000, MAX_LINE = 256 };

/* ---- knobs ---- */

static int count_knobs(const experiment *e) {
    int n = 0;
    while (e->knobs != NULL && e->knobs[n].name != NULL) {
        n++;
    }
    return n;
}

static int find_knob(const experiment *e, const char *name) {
    int n = count_knobs(e);
    for (int i = 0; i < n; i++) {
        if (strcmp(e->knobs[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

static int parse_number(const char *name, const char *text, char **end, double min, double max,
                        double *value, shear_error *err) {
    errno = 0;
    *value = strtod(text, end);
    if (*end == text || errno == ERANGE || !(*value >= min && *value <= max)) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "option '--%s': '%s' is not from %g to %g",
                          name, text, min, max);
    }
    return SHEAR_OK;
}

static int parse_knob(const struct knob *knob, const char *text, knob_values *values,
                      shear_error *err) {
    knob_values parsed = {0};
    const char *p = text;
    for (;;) {
        char *end = NULL;
        if (parsed.n == (knob->many ? MAX_KNOB_VALUES : 1)) {
            return shear_fail(err, SHEAR_E_SETTING, NULL, "option '--%s': more than %d values",
                              knob->name, parsed.n);
        }
        int code =
            parse_number(knob->name, p, &end, knob->min, knob->max, &parsed.v[parsed.n++], err);
        if (code != SHEAR_OK) {
            return code;
        }
        if (*end == '\0') {
            break;
        }
        if (*end != ',') {
            return shear_fail(err, SHEAR_E_SETTING, NULL,
                              "option '--%s': '%s' is not a list of numbers", knob->name, text);
        }
        p = end + 1;
    }
    *values = parsed;
    return SHEAR_OK;
}

const knob_values *request_list(const struct request *r, const char *name) {
    int i = find_knob(r->experiment, name);
    return i >= 0 ? &r->knobs[i] : NULL;
}

double request_number(const struct request *r, const char *name) {
    const knob_values *values = request_list(r, name);
    return values != NULL && values->n > 0 ? values->v[0] : NAN;
}

/* ---- common options ---- */

static int parse_count(const char *name, const char *text, int64_t min, int64_t max, int64_t *value,
                       shear_error *err) {
    char *end = NULL;
    double number = 0.0; /* so that 1e6 is a number of galaxies too */
    int code = parse_number(name, text, &end, (double)min, (double)max, &number, err);
    if (code == SHEAR_OK && (*end != '\0' || number != floor(number))) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "option '--%s': '%s' is not a whole number",
                          name, text);
    }
    *value = code == SHEAR_OK ? (int64_t)number : *value;
    return code;
}

static int set_int(const char *name, const char *text, int max, int *value, shear_error *err) {
    int64_t parsed = *value;
    int code = parse_count(name, text, 1, max, &parsed, err);
    *value = (int)parsed;
    return code;
}

static int set_out(struct request *r, const char *text, shear_error *err) {
    int n = snprintf(r->out, sizeof r->out, "%s", text);
    return n > 0 && (size_t)n < sizeof r->out - 64
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_SETTING, NULL,
                            "option '--out': no name, or too long a one");
}

/* The option's own argument is `value`; NULL where it has none. */
static int set_common(struct request *r, const char *name, const char *value, bool *known,
                      shear_error *err) {
    *known = true;
    if (strcmp(name, "fresh") == 0 || strcmp(name, "quiet") == 0) {
        *(name[0] == 'f' ? &r->fresh : &r->quiet) = true;
        return SHEAR_OK;
    }
    if (strcmp(name, "galaxies") == 0) {
        return parse_count(name, value, 1, 1000000000, &r->galaxies, err);
    }
    if (strcmp(name, "groups") == 0) {
        return set_int(name, value, MAX_GROUPS, &r->groups, err);
    }
    if (strcmp(name, "threads") == 0) {
        return set_int(name, value, MAX_THREADS, &r->threads, err);
    }
    if (strcmp(name, "out") == 0) {
        return set_out(r, value, err);
    }
    *known = false;
    return SHEAR_OK;
}

/* ---- one option ---- */

static bool is_fixed(const experiment *e, const char *name) {
    static const char *const never[] = {"stamps", "field", "layout", "bitpix", "no-r-gal"};
    for (size_t i = 0; i < sizeof never / sizeof *never; i++) {
        if (strcmp(never[i], name) == 0) {
            return true;
        }
    }
    for (const char *const *p = e->fixed; p != NULL && *p != NULL; p++) {
        if (strcmp(*p, name) == 0) {
            return true;
        }
    }
    return false;
}

static const shear_setting_def *find_setting(const char *name, const char **text) {
    static const char no[] = "no-";
    static const char measure[] = "measure-";
    const char *base =
        strncmp(name, measure, sizeof measure - 1) == 0 ? name + sizeof measure - 1 : name;
    const shear_setting_def *def = shear_settings_find(base);
    if (def == NULL && strncmp(base, no, sizeof no - 1) == 0) {
        def = shear_settings_find(base + sizeof no - 1);
        def = def != NULL && def->type == SHEAR_T_BOOL ? def : NULL;
        *text = def != NULL ? "no" : *text;
    } else if (def != NULL && def->type == SHEAR_T_BOOL) {
        *text = "yes";
    }
    return def;
}

static bool takes_value(const experiment *e, const char *name) {
    const shear_mock_option *mock = shear_mock_option_find(name);
    const char *text = NULL;
    if (strcmp(name, "fresh") == 0 || strcmp(name, "quiet") == 0) {
        return false;
    }
    if (find_knob(e, name) >= 0) {
        return true;
    }
    if (mock != NULL) {
        return mock->metavar != NULL;
    }
    find_setting(name, &text);
    return text == NULL;
}

/* A knob may have the name of an option that the experiment otherwise chooses itself. */
static int set_option(struct request *r, const char *name, const char *value, shear_error *err) {
    const experiment *e = r->experiment;
    int knob = find_knob(e, name);
    if (knob >= 0) {
        return parse_knob(&e->knobs[knob], value, &r->knobs[knob], err);
    }
    if (is_fixed(e, name)) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "option '--%s': %s chooses it itself", name,
                          e->name);
    }
    bool known = false;
    int code = set_common(r, name, value, &known, err);
    if (known) {
        return code;
    }
    if (shear_mock_option_find(name) != NULL) {
        return shear_mock_set(&r->mock, name, value, err);
    }
    const shear_setting_def *def = find_setting(name, &value);
    if (def != NULL) {
        return shear_settings_set(&r->settings, def->name, value, err);
    }
    return shear_fail(err, SHEAR_E_SETTING, "see \"shear-paper help\" and the experiment's name",
                      "unknown option '--%s'", name);
}

/* ---- the command line ---- */

/* What the numbers do not depend on is left out: the table is to be the same wherever it was made.
 */
static void keep_command(struct request *r, int argc, char **argv) {
    size_t used = (size_t)snprintf(r->command, sizeof r->command, "shear-paper");
    for (int i = 0; i < argc && used < sizeof r->command; i++) {
        bool valued = strcmp(argv[i], "--out") == 0 || strcmp(argv[i], "--threads") == 0;
        bool idle = strncmp(argv[i], "--out=", 6) == 0 || strncmp(argv[i], "--threads=", 10) == 0 ||
                    strcmp(argv[i], "--quiet") == 0 || strcmp(argv[i], "--fresh") == 0;
        if (!valued && !idle) {
            used += (size_t)snprintf(r->command + used, sizeof r->command - used, " %s", argv[i]);
        }
        i += valued;
    }
}

static int parse_argument(struct request *r, int argc, char **argv, int *i, shear_error *err) {
    char name[MAX_LINE];
    const char *argument = argv[*i];
    if (strncmp(argument, "--", 2) != 0 || strlen(argument) >= sizeof name) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "unexpected argument '%s'", argument);
    }
    const char *equals = strchr(argument, '=');
    size_t length = equals != NULL ? (size_t)(equals - argument) : strlen(argument);
    snprintf(name, sizeof name, "%.*s", (int)(length - 2), argument + 2);
    if (!takes_value(r->experiment, name)) {
        return set_option(r, name, NULL, err);
    }
    if (equals == NULL && *i + 1 == argc) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "option '--%s' needs a value", name);
    }
    return set_option(r, name, equals != NULL ? equals + 1 : argv[++*i], err);
}

/* The experiments repeat the paper. */
static void paper_settings(shear_settings *s) {
    (void)shear_settings_set(s, "preset", "zhang2010", NULL);
}

static int set_defaults(struct request *r, shear_error *err) {
    const experiment *e = r->experiment;
    shear_mock_spec_init(&r->mock);
    paper_settings(&r->settings);
    r->galaxies = 10000;
    r->groups = 100;
    snprintf(r->out, sizeof r->out, ".");
    e->defaults(r);
    int code = SHEAR_OK;
    for (int i = 0; code == SHEAR_OK && i < count_knobs(e); i++) {
        code = parse_knob(&e->knobs[i], e->knobs[i].preset, &r->knobs[i], err);
    }
    return code;
}

int request_parse(struct request *r, const experiment *e, int argc, char **argv, shear_error *err) {
    *r = (struct request){.experiment = e};
    int code = set_defaults(r, err);
    keep_command(r, argc, argv);
    for (int i = 1; code == SHEAR_OK && i < argc; i++) {
        code = parse_argument(r, argc, argv, &i, err);
    }
    return code;
}

/* ---- text ---- */

static void print_changed(const struct request *r, FILE *out) {
    size_t n = 0;
    shear_mock_spec plain;
    shear_mock_spec_init(&plain);
    const shear_mock_option *mock = shear_mock_options(&n);
    for (size_t i = 0; i < n; i++) {
        char ours[MAX_LINE];
        char theirs[MAX_LINE];
        shear_mock_format(&r->mock, &mock[i], ours, sizeof ours);
        shear_mock_format(&plain, &mock[i], theirs, sizeof theirs);
        if (strcmp(ours, theirs) != 0) {
            fprintf(out, "%s %s\n", mock[i].name, ours);
        }
    }
    shear_settings defaults;
    paper_settings(&defaults);
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++) {
        char ours[MAX_LINE];
        char theirs[MAX_LINE];
        shear_settings_format(&r->settings, &table[i], ours, sizeof ours);
        shear_settings_format(&defaults, &table[i], theirs, sizeof theirs);
        if (strcmp(ours, theirs) != 0) {
            fprintf(out, "measure-%s %s\n", table[i].name, ours);
        }
    }
}

static void print_knobs(const struct request *r, FILE *out) {
    for (int i = 0; i < count_knobs(r->experiment); i++) {
        fprintf(out, "%s ", r->experiment->knobs[i].name);
        for (int k = 0; k < r->knobs[i].n; k++) {
            fprintf(out, "%s%.17g", k > 0 ? "," : "", r->knobs[i].v[k]);
        }
        fputc('\n', out);
    }
}

char *request_describe(const struct request *r) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL) {
        return NULL;
    }
    fprintf(out, "experiment %s\ngalaxies %" PRId64 "\ngroups %d\n", r->experiment->name,
            r->galaxies, r->groups);
    print_knobs(r, out);
    print_changed(r, out);
    if (fclose(out) != 0) {
        free(text);
        return NULL;
    }
    return text;
}

char *request_path(const struct request *r, const char *suffix, const char *ext, char *buf,
                   size_t size) {
    snprintf(buf, size, "%s/%s%s%s.%s", r->out, r->experiment->name, suffix != NULL ? "-" : "",
             suffix != NULL ? suffix : "", ext);
    return buf;
}

void request_help(const experiment *e, FILE *out) {
    struct request r = {.experiment = e};
    shear_error err = {0};
    fprintf(out, "usage: shear-paper %s [OPTION...]\n\n%s\n\n", e->name, e->about);
    if (set_defaults(&r, &err) != 0) {
        fprintf(out, "%s\n", err.message);
        return;
    }
    fprintf(
        out,
        "  --galaxies N        stamps for each point, rotated copies included (default %" PRId64
        ")\n"
        "  --groups N          of the jackknife; also the pieces between checkpoints (default %d)\n"
        "  --seed S            the same seed draws the same galaxies and noise (default %" PRIu64
        ")\n"
        "  --threads N         the result does not depend on it (default: all cores)\n"
        "  --out DIR           where table, figure and state go (default .)\n"
        "  --fresh             begin anew where an earlier run was stopped\n"
        "  --quiet             no progress\n",
        r.galaxies, r.groups, r.mock.seed);
    for (int i = 0; i < count_knobs(e); i++) {
        const struct knob *k = &e->knobs[i];
        fprintf(out, "  --%-17s %s (default %s)\n", k->name, k->help, k->preset);
    }
    fputs("\nAll options of \"shearctl help mock\" and settings of \"shearctl help measure\" are "
          "taken "
          "as well;\nwhere both have a name, --measure-NAME is the setting. Here they are by "
          "default:\n",
          out);
    print_changed(&r, out);
    fputs("and what the experiment chooses itself:", out);
    for (const char *const *p = e->fixed; p != NULL && *p != NULL; p++) {
        if (find_knob(e, *p) < 0) {
            fprintf(out, " %s", *p);
        }
    }
    fputc('\n', out);
}
