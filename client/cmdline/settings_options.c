/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cmdline/settings_options.h"

#include "base/text.h"
#include "terminal/message.h"

#include <assert.h>
#include <string.h>

/* Return the name "no-..." of a boolean setting; an option only points to it. */
static const char *negated_name(size_t index, const char *name) {
    static char names[SETTINGS_OPTIONS_MAX][40];
    snprintf(names[index], sizeof names[index], "no-%s", name);
    return names[index];
}

static enum exit_code give(const option_entry *e, const char *name, const char *value) {
    option_settings *s = e->context;
    shear_error err = {0};
    return shear_settings_give(&s->values, s->given, name, value, &err) != SHEAR_OK
               ? message_error(&err)
               : EXIT_CODE_DONE;
}

static enum exit_code set_value(const option_entry *e, const char *value) {
    return give(e, e->name, e->bare ? "true" : value);
}

static enum exit_code set_false(const option_entry *e, const char *value) {
    (void)value;
    return give(e, e->name + strlen("no-"), "false");
}

size_t settings_options_add(option_entry *entries, option_settings *s) {
    size_t n = 0;
    size_t added = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    shear_settings_init(&s->values);
    for (size_t i = 0; i < n; i++) {
        const bool is_bool = table[i].type == SHEAR_T_BOOL;
        assert(added + 2 <= SETTINGS_OPTIONS_MAX);
        entries[added++] =
            (option_entry){.name = table[i].name, .set = set_value, .context = s, .bare = is_bool};
        if (is_bool) {
            entries[added++] = (option_entry){.name = negated_name(i, table[i].name),
                                              .set = set_false,
                                              .context = s,
                                              .bare = true};
        }
    }
    return added;
}

/* The text on a setting in the help and the manual. */
typedef struct setting_text {
    char choices[256]; /* "none, bilinear, bicubic"; "" unless it is a choice */
    char value[64];    /* its default */
    const char *unit;  /* of the default; "" if it has none */
} setting_text;

static void setting_text_init(setting_text *t, const shear_setting_def *def) {
    shear_settings s;
    shear_settings_init(&s);
    shear_settings_format(&s, def, t->value, sizeof t->value);
    t->unit = strcmp(t->value, "auto") == 0 ? "" : def->unit;
    t->choices[0] = '\0';
    if (def->type == SHEAR_T_CHOICE)
        text_list(t->choices, sizeof t->choices, def->choices);
}

static void print_help(const shear_setting_def *def, FILE *out) {
    static const char indent[] = "                          ";
    enum { INDENT = sizeof indent - 1 };
    char text[768];
    setting_text t;
    setting_text_init(&t, def);
    snprintf(text, sizeof text, "%s%s%s%s (default %s%s%s)", def->help,
             t.choices[0] != '\0' ? " (" : "", t.choices, t.choices[0] != '\0' ? ")" : "", t.value,
             t.unit[0] != '\0' ? " " : "", t.unit);
    int column = def->type == SHEAR_T_BOOL ? fprintf(out, "  --%s, --no-%s", def->name, def->name)
                                           : fprintf(out, "  --%s %s", def->name, def->metavar);
    if (column > INDENT - 2) {
        fputc('\n', out);
        column = 0;
    }
    fprintf(out, "%*s", INDENT - column, "");
    text_wrap(out, text, INDENT, indent);
}

void settings_options_help(FILE *out) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++)
        print_help(&table[i], out);
}

/* Print text as roff: escape backslashes and hyphens, and avoid control lines. */
static void print_roff(FILE *out, const char *text) {
    if (text[0] == '.' || text[0] == '\'')
        fputs("\\&", out);
    for (; *text != '\0'; text++) {
        if (*text == '\\') {
            fputs("\\e", out);
        } else if (*text == '-') {
            fputs("\\-", out);
        } else {
            fputc(*text, out);
        }
    }
}

static void print_man(const shear_setting_def *def, FILE *out) {
    setting_text t;
    setting_text_init(&t, def);
    if (def->type == SHEAR_T_BOOL) {
        fprintf(out, ".It Fl \\-%s , Fl \\-no\\-%s\n", def->name, def->name);
    } else {
        fprintf(out, ".It Fl \\-%s Ar %s\n", def->name, def->metavar);
    }
    print_roff(out, def->help);
    if (t.choices[0] != '\0') {
        fputs(".\nOne of: ", out);
        print_roff(out, t.choices);
    }
    fputs(".\nDefault: ", out);
    print_roff(out, t.value);
    if (t.unit[0] != '\0') {
        fputc(' ', out);
        print_roff(out, t.unit);
    }
    fputs(".\n", out);
}

void settings_options_man(FILE *out) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++)
        print_man(&table[i], out);
}
