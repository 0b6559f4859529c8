/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/options.h"

#include "base/text.h"
#include "engine/must.h"

#include <assert.h>
#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_LINE = 256, MAX_OPTIONS = 256, MAX_NAME = 48 };

/* ---- parameters ---- */

static int find_parameter(const experiment *e, const char *name) {
    for (int i = 0; e->parameters != NULL && e->parameters[i].name != NULL; i++) {
        if (strcmp(e->parameters[i].name, name) == 0)
            return i;
    }
    return -1;
}

const parameter_values *options_list(const options *o, const char *name) {
    const int i = find_parameter(o->experiment, name);
    assert(i >= 0);
    return &o->parameters[i];
}

double options_number(const options *o, const char *name) {
    return options_list(o, name)->v[0];
}

static double parse_number(const char *name, const char *text, char **end, double min, double max) {
    errno = 0;
    const double value = strtod(text, end);
    if (*end == text || errno == ERANGE || !(value >= min && value <= max)) {
        must_fail(SHEAR_E_SETTING, NULL, "option '--%s': '%s' is not from %g to %g", name, text,
                  min, max);
    }
    return value;
}

static void parse_parameter(const parameter *p, const char *text, parameter_values *out) {
    const int most = p->most > 1 ? MAX_VALUES : 1;
    char *end = NULL;
    out->n = 0;
    const char *at = text;
    do {
        if (out->n == most)
            must_fail(SHEAR_E_SETTING, NULL, "option '--%s': more than %d values", p->name, most);
        out->v[out->n++] = parse_number(p->name, at, &end, p->min, p->max);
        at = end + 1;
    } while (*end == ',');
    if (*end != '\0') {
        must_fail(SHEAR_E_SETTING, NULL, "option '--%s': '%s' is not a list of numbers", p->name,
                  text);
    }
}

static void check_counts(const options *o) {
    const parameter *p = o->experiment->parameters;
    for (int i = 0; p != NULL && p[i].name != NULL; i++) {
        if (o->parameters[i].n > p[i].most)
            must_fail(SHEAR_E_SETTING, NULL, "option '--%s': at most %d", p[i].name, p[i].most);
    }
}

/* ---- common options ---- */

enum common_type { COUNT, NUMBER, FOLDER, SWITCH };
static const struct {
    const char *name;
    enum common_type type;
    size_t offset;
    double max;
    bool kept; /* the numbers depend on it */
} commons[] = {{"galaxies", COUNT, offsetof(options, galaxies), 1e9, true},
               {"groups", NUMBER, offsetof(options, groups), 100000, true},
               {"threads", NUMBER, offsetof(options, threads), 1024, false},
               {"out", FOLDER, offsetof(options, out), 0, false},
               {"fresh", SWITCH, offsetof(options, fresh), 0, false},
               {"quiet", SWITCH, offsetof(options, quiet), 0, false}};
enum { N_COMMON = sizeof commons / sizeof commons[0] };

/* Parse a double, so that 1e6 is a valid number of galaxies. */
static int64_t parse_count(const char *name, const char *text, double max) {
    char *end = NULL;
    const double number = parse_number(name, text, &end, 1.0, max);
    if (*end != '\0' || number != floor(number))
        must_fail(SHEAR_E_SETTING, NULL, "option '--%s': '%s' is not a whole number", name, text);
    return (int64_t)number;
}

static void set_folder(char *out, size_t size, const char *text) {
    if (text[0] == '\0' || strlen(text) >= size - 64)
        must_fail(SHEAR_E_SETTING, NULL, "option '--out': no name, or too long a one");
    text_set(out, size, text);
}

static void set_common(options *o, int i, const char *value) {
    const char *name = commons[i].name;
    void *member = (char *)o + commons[i].offset;
    switch (commons[i].type) {
    case COUNT:
        *(int64_t *)member = parse_count(name, value, commons[i].max);
        break;
    case NUMBER:
        *(int *)member = (int)parse_count(name, value, commons[i].max);
        break;
    case FOLDER:
        set_folder(member, sizeof o->out, value);
        break;
    default:
        *(bool *)member = true;
        break;
    }
}

/* ---- the table for getopt_long ---- */

/* The kinds of options: `val` is the kind plus an index into the kind's table. */
enum kind { PARAMETER = 1000, COMMON = 2000, MOCK = 3000, SETTING = 4000, SETTING_OFF = 5000 };

typedef struct option_table {
    int n;
    struct option list[MAX_OPTIONS]; /* getopt_long finds the first option of a name */
    char names[MAX_OPTIONS][MAX_NAME];
} option_table;

static void add_option(option_table *t, const char *prefix, const char *name, bool valued,
                       int value) {
    assert(t->n + 1 < MAX_OPTIONS);
    snprintf(t->names[t->n], MAX_NAME, "%s%s", prefix, name);
    t->list[t->n] =
        (struct option){t->names[t->n], valued ? required_argument : no_argument, NULL, value};
    t->n++;
}

static void add_setting(option_table *t, const shear_setting_def *def, int i) {
    const bool valued = def->type != SHEAR_T_BOOL;
    add_option(t, "", def->name, valued, SETTING + i);
    add_option(t, "measure-", def->name, valued, SETTING + i);
    if (!valued) {
        add_option(t, "no-", def->name, false, SETTING_OFF + i);
        add_option(t, "measure-no-", def->name, false, SETTING_OFF + i);
    }
}

static void fill_table(option_table *t, const experiment *e) {
    size_t n = 0;
    for (int i = 0; e->parameters != NULL && e->parameters[i].name != NULL; i++)
        add_option(t, "", e->parameters[i].name, true, PARAMETER + i);
    for (int i = 0; i < N_COMMON; i++)
        add_option(t, "", commons[i].name, commons[i].type != SWITCH, COMMON + i);
    const shear_mock_option *mock = shear_mock_options(&n);
    for (size_t i = 0; i < n; i++)
        add_option(t, "", mock[i].name, mock[i].metavar != NULL, MOCK + (int)i);
    const shear_setting_def *settings = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++)
        add_setting(t, &settings[i], (int)i);
}

/* ---- one option ---- */

/* Return whether `name` is one of the words, which are separated by spaces. */
static bool has_word(const char *words, const char *name) {
    const size_t length = strlen(name);
    for (const char *at = words; (at = strstr(at, name)) != NULL; at += length) {
        const bool begins = at == words || at[-1] == ' ';
        if (begins && (at[length] == ' ' || at[length] == '\0'))
            return true;
    }
    return false;
}

/* Set any option except parameters. */
static void set_value(options *o, const struct option *option, const char *value) {
    const int kind = option->val / 1000 * 1000;
    const int i = option->val % 1000;
    size_t n = 0;
    if (kind == COMMON) {
        set_common(o, i, value);
    } else if (kind == MOCK) {
        must(shear_mock_set(&o->mock, shear_mock_options(&n)[i].name, value, &must_error));
    } else {
        const char *text = value != NULL ? value : kind == SETTING ? "yes" : "no";
        must(shear_settings_set(&o->settings, shear_settings_table(&n)[i].name, text, &must_error));
    }
}

/* Set an option. A parameter may have the name of an option that the experiment sets itself. */
static void set_option(options *o, const struct option *option, const char *value) {
    static const char never[] = "stamps field layout bitpix no-r-gal";
    const experiment *e = o->experiment;
    if (option->val < COMMON) {
        const int i = option->val - PARAMETER;
        parse_parameter(&e->parameters[i], value, &o->parameters[i]);
        return;
    }
    if (has_word(never, option->name) || has_word(e->fixed, option->name)) {
        must_fail(SHEAR_E_SETTING, NULL, "option '--%s': %s chooses it itself", option->name,
                  e->name);
    }
    set_value(o, option, value);
}

/* ---- the command line ---- */

static void append_word(options *o, const char *word) {
    text_append(o->command, sizeof o->command, "%s%s", o->command[0] != '\0' ? " " : "", word);
}

/* Return whether the numbers depend on the option. Others are left out of the table, so that it
 * does not depend on the machine. */
static bool is_kept(const struct option *option) {
    const int i = option->val - COMMON;
    return i < 0 || i >= N_COMMON || commons[i].kept;
}

static _Noreturn void fail_at(const char *given, int value) {
    const int length = (int)strcspn(given, "=");
    if (strncmp(given, "--", 2) != 0)
        must_fail(SHEAR_E_SETTING, NULL, "unexpected argument '%s'", given);
    if (value == ':')
        must_fail(SHEAR_E_SETTING, NULL, "option '%s' needs a value", given);
    if (optopt != 0)
        must_fail(SHEAR_E_SETTING, NULL, "option '%.*s' takes no value", length, given);
    must_fail(SHEAR_E_SETTING, "see \"shear-paper help\" and the experiment's name",
              "unknown option '%.*s'", length, given);
}

/* Use the settings of the paper, which the experiments repeat. */
static void paper_settings(shear_settings *s) {
    (void)shear_settings_set(s, "preset", "zhang2010", NULL);
}

/* Return the option of this name that is not a parameter, or NULL. */
static const struct option *find_option(const option_table *t, const char *name) {
    const struct option *option = t->list;
    while (option->val < COMMON || strcmp(option->name, name) != 0) {
        option++;
        assert(option->name != NULL);
    }
    return option;
}

static void set_defaults(options *o, const option_table *t, const experiment *e) {
    char words[2 * MAX_LINE];
    char *rest = NULL;
    *o = (options){.experiment = e, .galaxies = 10000, .groups = 100, .out = "."};
    shear_mock_spec_init(&o->mock);
    paper_settings(&o->settings);
    snprintf(words, sizeof words, "%s", e->defaults);
    for (char *name = strtok_r(words, " =", &rest); name != NULL;
         name = strtok_r(NULL, " =", &rest)) {
        set_value(o, find_option(t, name), strtok_r(NULL, " =", &rest));
    }
    for (int i = 0; e->parameters != NULL && e->parameters[i].name != NULL; i++)
        parse_parameter(&e->parameters[i], e->parameters[i].preset, &o->parameters[i]);
}

void options_parse(options *o, const experiment *e, int argc, char **argv) {
    option_table table = {0};
    fill_table(&table, e);
    set_defaults(o, &table, e);
    append_word(o, "shear-paper");
    append_word(o, argv[0]);
    opterr = 0;
    int value = 0;
    int index = 0;
    for (int at = 1; (value = getopt_long(argc, argv, "+:", table.list, &index)) != -1;) {
        if (value == '?' || value == ':')
            fail_at(argv[at], value);
        set_option(o, &table.list[index], optarg);
        for (; at < optind; at++) {
            if (is_kept(&table.list[index]))
                append_word(o, argv[at]);
        }
    }
    if (optind < argc)
        must_fail(SHEAR_E_SETTING, NULL, "unexpected argument '%s'", argv[optind]);
    check_counts(o);
}

/* ---- text ---- */

static void print_if_changed(FILE *out, const char *prefix, const char *name, const char *ours,
                             const char *theirs) {
    if (strcmp(ours, theirs) != 0)
        fprintf(out, "%s%s %s\n", prefix, name, ours);
}

static void print_changed(const options *o, FILE *out) {
    size_t n = 0;
    char ours[MAX_LINE];
    char theirs[MAX_LINE];
    shear_mock_spec plain;
    shear_settings paper;
    shear_mock_spec_init(&plain);
    paper_settings(&paper);
    const shear_mock_option *mock = shear_mock_options(&n);
    for (size_t i = 0; i < n; i++) {
        print_if_changed(out, "", mock[i].name,
                         shear_mock_format(&o->mock, &mock[i], ours, sizeof ours),
                         shear_mock_format(&plain, &mock[i], theirs, sizeof theirs));
    }
    const shear_setting_def *settings = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++) {
        print_if_changed(out, "measure-", settings[i].name,
                         shear_settings_format(&o->settings, &settings[i], ours, sizeof ours),
                         shear_settings_format(&paper, &settings[i], theirs, sizeof theirs));
    }
}

char *options_describe(const options *o) {
    char *text = NULL;
    size_t size = 0;
    const experiment *e = o->experiment;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL)
        must_fail(SHEAR_E_NOMEM, NULL, "out of memory for the options");
    fprintf(out, "experiment %s\ngalaxies %" PRId64 "\ngroups %d\n", e->name, o->galaxies,
            o->groups);
    for (int i = 0; e->parameters != NULL && e->parameters[i].name != NULL; i++) {
        fprintf(out, "%s ", e->parameters[i].name);
        for (int k = 0; k < o->parameters[i].n; k++)
            fprintf(out, "%s%.17g", k > 0 ? "," : "", o->parameters[i].v[k]);
        fputc('\n', out);
    }
    print_changed(o, out);
    if (fclose(out) != 0)
        must_fail(SHEAR_E_NOMEM, NULL, "out of memory for the options");
    return text;
}

char *options_path(const options *o, const char *suffix, const char *ext, char path[OPTIONS_PATH]) {
    snprintf(path, OPTIONS_PATH, "%s/%s%s%s.%s", o->out, o->experiment->name,
             suffix != NULL ? "-" : "", suffix != NULL ? suffix : "", ext);
    return path;
}

void options_help(const experiment *e, FILE *out) {
    options o;
    option_table table = {0};
    fill_table(&table, e);
    set_defaults(&o, &table, e);
    fprintf(out, "usage: shear-paper %s [OPTION...]\n\n%s\n\n", e->name, e->about);
    fprintf(
        out,
        "  --galaxies N        stamps for each point, rotated copies included (default %" PRId64
        ")\n"
        "  --groups N          of the jackknife; also the pieces between checkpoints (default "
        "%d)\n"
        "  --seed S            the same seed draws the same galaxies and noise (default %" PRIu64
        ")\n"
        "  --threads N         the result does not depend on it (default: all cores)\n"
        "  --out DIR           where table, figure and state go (default .)\n"
        "  --fresh             start over where an earlier run was stopped\n"
        "  --quiet             no progress\n",
        o.galaxies, o.groups, o.mock.seed);
    for (const parameter *p = e->parameters; p != NULL && p->name != NULL; p++)
        fprintf(out, "  --%-17s %s (default %s)\n", p->name, p->help, p->preset);
    fputs("\nAll options of \"shearctl help mock\" and settings of \"shearctl help measure\" are "
          "taken as well;\n"
          "where both have a name, --measure-NAME is the setting. Here they are by default:\n",
          out);
    print_changed(&o, out);
    fputs("and what the experiment chooses itself:", out);
    char words[2 * MAX_LINE];
    char *rest = NULL;
    snprintf(words, sizeof words, "%s", e->fixed);
    for (char *word = strtok_r(words, " ", &rest); word != NULL;
         word = strtok_r(NULL, " ", &rest)) {
        if (find_parameter(e, word) < 0)
            fprintf(out, " %s", word);
    }
    fputc('\n', out);
}
