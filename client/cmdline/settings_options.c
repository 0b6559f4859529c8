/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cmdline/settings_options.h"

#include "base/text.h"

#include <string.h>

/* Each setting has two values: FIRST + 2 i is --NAME, FIRST + 2 i + 1 is --no-NAME. */
static size_t index_of(int value) {
    return (size_t)(value - SETTINGS_OPTION_FIRST) / 2;
}

/* Return the name "no-..." of a boolean setting; struct option only points to it. */
static const char *negated_name(size_t index, const char *name) {
    static char names[SETTINGS_OPTIONS_MAX][40];
    snprintf(names[index], sizeof names[index], "no-%s", name);
    return names[index];
}

size_t settings_options_fill(struct option *options, size_t capacity) {
    size_t n = 0;
    size_t written = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n && i < SETTINGS_OPTIONS_MAX && written + 2 < capacity; i++) {
        bool is_bool = table[i].type == SHEAR_T_BOOL;
        int value = SETTINGS_OPTION_FIRST + 2 * (int)i;
        options[written++] =
            (struct option){table[i].name, is_bool ? no_argument : required_argument, NULL, value};
        if (is_bool) {
            options[written++] =
                (struct option){negated_name(i, table[i].name), no_argument, NULL, value + 1};
        }
    }
    if (written < capacity)
        options[written] = (struct option){NULL, 0, NULL, 0};
    return written;
}

bool settings_options_is(int value) {
    size_t n = 0;
    shear_settings_table(&n);
    return value >= SETTINGS_OPTION_FIRST && index_of(value) < n;
}

int settings_options_handle(int value, const char *argument, shear_settings *s, bool *given,
                            shear_error *err) {
    size_t n = 0;
    const shear_setting_def *def = &shear_settings_table(&n)[index_of(value)];
    if (def->type == SHEAR_T_BOOL) {
        bool negated = (value - SETTINGS_OPTION_FIRST) % 2 == 1;
        return shear_settings_give(s, given, def->name, negated ? "false" : "true", err);
    }
    return shear_settings_give(s, given, def->name, argument, err);
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

/* Print the words of `text` from column `indent` on, at most 78 columns wide; the cursor is at
 * `column`. */
static void print_wrapped(FILE *out, const char *text, int column, int indent) {
    while (*text != '\0') {
        int length = (int)strcspn(text, " ");
        if (column + 1 + length > 78 && column > indent) {
            fprintf(out, "\n%*s", indent, "");
            column = indent;
        } else if (column > indent) {
            fputc(' ', out);
            column++;
        }
        fprintf(out, "%.*s", length, text);
        column += length;
        text += length;
        text += strspn(text, " ");
    }
    fputc('\n', out);
}

static void print_help(const shear_setting_def *def, FILE *out) {
    enum { INDENT = 26 };
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
    print_wrapped(out, text, INDENT, INDENT);
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
