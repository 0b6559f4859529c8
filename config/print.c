/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Print configurations as files: the commented sample, and the settings in effect. */
#include "base/cleanup.h"
#include "base/text.h"
#include "origin.h"
#include "text.h"
#include "value.h"

#include <string.h>

enum { EXPECTED_MAX = 256 };

static const char preamble[] =
    "Every setting is listed with its default after a '#': remove the '#' to change one. Settings "
    "are written key = value, in their section. A comment is a line that begins with '#' or ';', "
    "or what follows ' ;' after a value. A list may go on in further lines that begin with a "
    "space. Sizes have the units K, M, G, T (powers of 1024), durations ms, s, min, h, d.";
static const char preamble_use[] =
    "sheard --check-config lists the errors of this file; systemctl reload sheard (or shearctl "
    "reload) makes the daemon read it again, but keep its old configuration if there are errors. "
    "See sheard.conf(5).";

static void comment(FILE *out, const char *text) {
    fputs("# ", out);
    text_wrap(out, text, 2, "# ");
}

/* Return whether the i-th setting is the first of its section. */
static bool begins_section(size_t i) {
    return i == 0 || strcmp(sheard_setting_at(i).section, sheard_setting_at(i - 1).section) != 0;
}

/* Print "key = value"; a list has a line per item, so that no line is too long. */
static void print_value(FILE *out, const char *lead, const sheard_setting *s, const char *text) {
    const bool is_list = value_is_list(s);
    fprintf(out, "%s%s =%s", lead, s->key, *text != '\0' ? " " : "");
    for (const char *comma; is_list && (comma = strstr(text, ", ")) != NULL; text = comma + 2)
        fprintf(out, "%.*s,\n%s    ", (int)(comma - text), text, lead);
    fprintf(out, "%s\n", text);
}

static int print_setting(FILE *out, const sheard_config *config, size_t i, const char *lead,
                         shear_error *err) {
    sheard_setting s = sheard_setting_at(i);
    CLEANUP(release_free) char *text = sheard_config_format(config, i);
    if (text == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for printing");
    print_value(out, lead, &s, text);
    return SHEAR_OK;
}

int sheard_config_print(const sheard_config *config, FILE *out, shear_error *err) {
    char where[256];
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        if (begins_section(i))
            fprintf(out, "%s[%s]\n", i > 0 ? "\n" : "", sheard_setting_at(i).section);
        fprintf(out, "# %s\n", config_where(config, i, where, sizeof where));
        TRY(print_setting(out, config, i, "", err));
    }
    return text_flushed(out, err);
}

static int sample_setting(FILE *out, const sheard_config *defaults, size_t i, shear_error *err) {
    sheard_setting s = sheard_setting_at(i);
    char text[EXPECTED_MAX];
    if (begins_section(i)) {
        fputs("\n\n", out);
        comment(out, sheard_section_help(s.section));
        fprintf(out, "[%s]\n", s.section);
    }
    fputc('\n', out);
    comment(out, s.help);
    comment(out, text_expected(&s, text, sizeof text));
    if (s.at_start)
        comment(out, "A change takes effect at the next start.");
    return print_setting(out, defaults, i, "#", err);
}

int sheard_config_print_sample(FILE *out, shear_error *err) {
    CLEANUP(sheard_config_deinit) sheard_config defaults = {0};
    TRY(sheard_config_init(&defaults, err));
    fputs("# SPDX-License-Identifier: GPL-3.0-or-later\n"
          "# sheard.conf: the configuration of sheard.\n#\n",
          out);
    comment(out, preamble);
    fputs("#\n", out);
    comment(out, preamble_use);
    for (size_t i = 0; i < sheard_settings_count(); i++)
        TRY(sample_setting(out, &defaults, i, err));
    return text_flushed(out, err);
}
