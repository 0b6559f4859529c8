/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/preset.h"

#include <stddef.h>

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

int preset_apply(shear_settings *s, int preset, shear_error *err) {
    int code = SHEAR_OK;
    shear_settings_init(s);
    s->preset = preset;
    for (const preset_value *v = presets[preset]; v != NULL && v->name != NULL && code == SHEAR_OK;
         v++) {
        code = shear_settings_set(s, v->name, v->text, err);
    }
    return code;
}
