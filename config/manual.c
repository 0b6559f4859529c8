/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Print the settings as sections of an mdoc manual page. */
#include "base/cleanup.h"
#include "text.h"

#include <string.h>

/* Print text for roff: escape backslashes and hyphens, avoid accidental control lines, and begin
 * each sentence on a new line, as mdoc requires. */
static void print_roff(FILE *out, const char *text) {
    bool line_begins = true;
    for (; *text != '\0'; text++) {
        if (line_begins && (*text == '.' || *text == '\''))
            fputs("\\&", out);
        line_begins = text[0] == '.' && text[1] == ' ';
        if (line_begins) {
            fputs(".\n", out);
            text++;
        } else if (*text == '\\') {
            fputs("\\e", out);
        } else if (*text == '-') {
            fputs("\\-", out);
        } else {
            fputc(*text, out);
        }
    }
}

static void print_sentence(FILE *out, const char *text) {
    print_roff(out, text);
    size_t n = strlen(text);
    fputs(n > 0 && text[n - 1] == '.' ? "\n" : ".\n", out);
}

static int print_setting(FILE *out, const sheard_config *defaults, size_t i, shear_error *err) {
    sheard_setting s = sheard_setting_at(i);
    char text[256];
    CLEANUP(release_free) char *initial = sheard_config_format(defaults, i);
    if (initial == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the manual");
    fputs(".It Cm ", out);
    print_roff(out, s.key);
    fputc('\n', out);
    print_sentence(out, s.help);
    print_sentence(out, text_expected(&s, text, sizeof text));
    fputs("Default: ", out);
    print_sentence(out, *initial != '\0' ? initial : "empty");
    if (s.at_start)
        print_sentence(out, "A change takes effect at the next start.");
    if (s.flag != NULL)
        fprintf(out, "On the command line:\n.Fl \\-%s .\n", s.flag);
    return SHEAR_OK;
}

static int print_all(FILE *out, const sheard_config *defaults, shear_error *err) {
    const char *section = "";
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        sheard_setting s = sheard_setting_at(i);
        if (strcmp(s.section, section) != 0) {
            fputs(*section != '\0' ? ".El\n" : "", out);
            section = s.section;
            fprintf(out, ".Ss [%s]\n", section);
            print_sentence(out, sheard_section_help(section));
            fputs(".Bl -tag -width Ds\n", out);
        }
        TRY(print_setting(out, defaults, i, err));
    }
    fputs(".El\n", out);
    return text_flushed(out, err);
}

int sheard_config_print_manual(FILE *out, shear_error *err) {
    CLEANUP(sheard_config_deinit) sheard_config defaults = {0};
    TRY(sheard_config_init(&defaults, err));
    return print_all(out, &defaults, err);
}
