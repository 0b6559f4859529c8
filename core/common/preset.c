/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/preset.h"

#include <stddef.h>
#include <string.h>

typedef struct preset_value {
    const char *name, *text;
} preset_value;

/* Where a preset differs from the library's defaults; each list ends with a NULL. */
static const preset_value zhang2010[] = {
    {"interpolation", "paper"}, {"beta-ratio", "1.5"},   {"beta-floor", "0"},   {"filter", "r-gal"},
    {"background", "keep"},     {"noise-level", "none"}, {"artefacts", "keep"}, {NULL, NULL},
};
static const preset_value *const presets[] = {
    [SHEAR_PRESET_DEFAULT] = NULL,
    [SHEAR_PRESET_ZHANG2010] = zhang2010,
};

int preset_apply(shear_settings *s, enum shear_preset preset, shear_error *err) {
    int code = SHEAR_OK;
    shear_settings_init(s);
    s->preset = preset;
    for (const preset_value *v = presets[preset]; v != NULL && v->name != NULL && code == SHEAR_OK;
         v++) {
        code = shear_settings_set(s, v->name, v->text, err);
    }
    return code;
}

static size_t size_of(const shear_setting_def *def) {
    return def->type == SHEAR_T_BOOL     ? sizeof(bool)
           : def->type == SHEAR_T_DOUBLE ? sizeof(double)
                                         : sizeof(int);
}

/* What has been given of `from`, to *s. */
static void keep_given(shear_settings *s, const shear_settings *from, const bool *given) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 1; i < n; i++) { /* 0 is the preset */
        if (given[i]) {
            char *to = (char *)s + table[i].offset;
            memcpy(to, (const char *)from + table[i].offset, size_of(&table[i]));
        }
    }
}

int shear_settings_give(shear_settings *s, bool *given, const char *name, const char *text,
                        shear_error *err) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    const shear_settings before = *s;
    const int code = shear_settings_set(s, name, text, err);
    const shear_setting_def *def = shear_settings_find(name);
    if (code != SHEAR_OK) {
        return code;
    }
    if (def == table) {
        keep_given(s, &before, given);
    }
    given[def - table] = true;
    return SHEAR_OK;
}
