/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cmdline/settings_options.h"

#include <string.h>

/* Two values a setting: FIRST + 2 i is --NAME, FIRST + 2 i + 1 is --no-NAME. */
static size_t index_of(int value) {
    return (size_t)(value - SETTINGS_OPTION_FIRST) / 2;
}

/* The names "no-..." of the boolean settings, which struct option only points to. */
static const char *negated_name(size_t index, const char *name) {
    static char names[SETTINGS_OPTIONS_MAX][40];
    snprintf(names[index], sizeof names[index], "no-%s", name);
    return names[index];
}

size_t settings_options_fill(struct option *options, size_t room) {
    size_t n = 0;
    size_t written = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n && i < SETTINGS_OPTIONS_MAX && written + 2 < room; i++) {
        bool is_bool = table[i].type == SHEAR_T_BOOL;
        int value = SETTINGS_OPTION_FIRST + 2 * (int)i;
        options[written++] =
            (struct option){table[i].name, is_bool ? no_argument : required_argument, NULL, value};
        if (is_bool) {
            options[written++] =
                (struct option){negated_name(i, table[i].name), no_argument, NULL, value + 1};
        }
    }
    if (written < room) {
        options[written] = (struct option){NULL, 0, NULL, 0};
    }
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

/* "--beta PX", "--noise-correction, --no-noise-correction" */
static void format_flag(const shear_setting_def *def, char *buf, size_t size) {
    if (def->type == SHEAR_T_BOOL) {
        snprintf(buf, size, "--%s, --no-%s", def->name, def->name);
    } else {
        snprintf(buf, size, "--%s %s", def->name, def->metavar);
    }
}

static const char *default_text(const shear_setting_def *def, char *buf, size_t size) {
    shear_settings s;
    shear_settings_init(&s);
    return shear_settings_format(&s, def, buf, size);
}

/* "none, bilinear, bicubic" of a choice, "" of others. */
static void format_choices(const shear_setting_def *def, char *buf, size_t size) {
    size_t used = 0;
    buf[0] = '\0';
    if (def->type != SHEAR_T_CHOICE) {
        return;
    }
    for (const char *const *c = def->choices; *c != NULL && used < size; c++) {
        int n = snprintf(buf + used, size - used, "%s%s", used != 0 ? ", " : "", *c);
        used += n > 0 ? (size_t)n : 0;
    }
}

/* Print words of `text` from column `indent`, at most 78 wide; the cursor is at `column`. */
static void print_wrapped(FILE *out, const char *text, int column, int indent) {
    while (*text) {
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

void settings_options_help(FILE *out) {
    enum { INDENT = 26 };
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++) {
        char flag[96];
        char choices[256];
        char value[64];
        char text[768];
        format_flag(&table[i], flag, sizeof flag);
        format_choices(&table[i], choices, sizeof choices);
        default_text(&table[i], value, sizeof value);
        snprintf(text, sizeof text, "%s%s%s%s%s (default %s%s%s)", table[i].help,
                 choices[0] ? " (" : "", choices, choices[0] ? ")" : "", "", value,
                 table[i].unit[0] && strcmp(value, "auto") != 0 ? " " : "",
                 table[i].unit[0] && strcmp(value, "auto") != 0 ? table[i].unit : "");
        int column = fprintf(out, "  %s", flag);
        if (column > INDENT - 2) {
            fputc('\n', out);
            column = 0;
        }
        fprintf(out, "%*s", INDENT - column, "");
        print_wrapped(out, text, INDENT, INDENT);
    }
}

/* Text for roff: backslashes and hyphens as such, and no control line by accident. */
static void print_roff(FILE *out, const char *text) {
    if (text[0] == '.' || text[0] == '\'') {
        fputs("\\&", out);
    }
    for (; *text; text++) {
        if (*text == '\\') {
            fputs("\\e", out);
        } else if (*text == '-') {
            fputs("\\-", out);
        } else {
            fputc(*text, out);
        }
    }
}

void settings_options_man(FILE *out) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++) {
        char choices[256];
        char value[64];
        if (table[i].type == SHEAR_T_BOOL) {
            fprintf(out, ".It Fl \\-%s , Fl \\-no\\-%s\n", table[i].name, table[i].name);
        } else {
            fprintf(out, ".It Fl \\-%s Ar %s\n", table[i].name, table[i].metavar);
        }
        print_roff(out, table[i].help);
        format_choices(&table[i], choices, sizeof choices);
        if (choices[0]) {
            fputs(".\nOne of: ", out);
            print_roff(out, choices);
        }
        fputs(".\nDefault: ", out);
        print_roff(out, default_text(&table[i], value, sizeof value));
        if (table[i].unit[0] && strcmp(value, "auto") != 0) {
            fputc(' ', out);
            print_roff(out, table[i].unit);
        }
        fputs(".\n", out);
    }
}
