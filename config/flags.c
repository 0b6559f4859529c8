/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Provide command-line options for settings. */
#include "base/cleanup.h"
#include "base/text.h"
#include "sheard/config.h"
#include "text.h"
#include "value.h"

#include <getopt.h>
#include <string.h>

size_t sheard_flags_fill(struct option *options, size_t capacity) {
    size_t n = 0;
    for (size_t i = 0; i < sheard_settings_count() && n + 1 < capacity; i++) {
        sheard_setting s = sheard_setting_at(i);
        if (s.flag != NULL) {
            options[n++] =
                (struct option){s.flag, required_argument, NULL, SHEARD_FLAG_FIRST + (int)i};
        }
    }
    if (n < capacity)
        options[n] = (struct option){NULL, 0, NULL, 0};
    return n;
}

int sheard_flags_assign(int val, const char *argument, sheard_list *assignments, shear_error *err) {
    CLEANUP(release_free) char *text = NULL;
    const ptrdiff_t index = (ptrdiff_t)val - SHEARD_FLAG_FIRST;
    if (index < 0 || (size_t)index >= sheard_settings_count())
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "option value %d is no setting's", val);
    sheard_setting s = sheard_setting_at((size_t)index);
    if (asprintf(&text, "%s.%s=%s", s.section, s.key, argument) < 0) {
        text = NULL; /* undefined after a failure of asprintf */
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for --%s", s.flag);
    }
    return sheard_list_append(assignments, text, err);
}

void sheard_flags_help(FILE *out) {
    static const char indent[] = "                            ";
    enum { COLUMN = sizeof indent - 1 };
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        sheard_setting s = sheard_setting_at(i);
        char text[1024];
        if (s.flag == NULL)
            continue;
        int column = fprintf(out, "  --%s %s", s.flag, value_placeholder(&s));
        char expected[256];
        snprintf(text, sizeof text, "[%s] %s: %s %s (default %s)", s.section, s.key, s.help,
                 text_expected(&s, expected, sizeof expected),
                 s.initial[0] != '\0' ? s.initial : "empty");
        fprintf(out, "%*s", column < COLUMN ? COLUMN - column : 1, "");
        text_wrap(out, text, COLUMN, indent);
    }
}
