/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Check that each setting is in its range and that they do not contradict each other. */
#include "shear/settings.h"

#include "base/cleanup.h"

#include <math.h>

static bool is_power_of_two(int n) {
    return n > 0 && (n & (n - 1)) == 0;
}

static bool in_range(const shear_settings *s, const shear_setting_def *def) {
    const void *value = (const char *)s + def->offset;
    switch (def->type) {
    case SHEAR_T_CHOICE: {
        int n = 0;
        while (def->choices[n] != NULL)
            n++;
        return *(const int *)value >= 0 && *(const int *)value < n;
    }
    case SHEAR_T_INT: {
        const int number = *(const int *)value;
        return (def->has_auto && number == 0) || (number >= def->min && number <= def->max);
    }
    case SHEAR_T_DOUBLE: {
        const double number = *(const double *)value;
        return (def->has_auto && isnan(number)) || (number >= def->min && number <= def->max);
    }
    default:
        return true;
    }
}

/* Check values that were set directly, not through shear_settings_set. */
static int check_ranges(const shear_settings *s, shear_error *err) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++) {
        if (!in_range(s, &table[i])) {
            return shear_fail(err, SHEAR_E_SETTING, NULL, "setting '%s' is out of range",
                              table[i].name);
        }
    }
    return SHEAR_OK;
}

static int check_oversample(const shear_settings *s, shear_error *err) {
    if (s->oversample != 0 && !is_power_of_two(s->oversample)) {
        return shear_fail(err, SHEAR_E_SETTING, NULL,
                          "setting 'oversample': %d is not a power of two", s->oversample);
    }
    if (s->interpolation == SHEAR_INTERP_NONE && s->oversample > 1) {
        return shear_fail(err, SHEAR_E_SETTING,
                          "choose an interpolation, or leave oversample at auto",
                          "setting 'oversample' is %d but interpolation is none", s->oversample);
    }
    return SHEAR_OK;
}

static int check_filter(const shear_settings *s, shear_error *err) {
    if (!isnan(s->core_px) && s->filter != SHEAR_FILTER_AUTO && s->filter != SHEAR_FILTER_R_GAL) {
        return shear_fail(err, SHEAR_E_SETTING, "a core of your own goes with filter=auto",
                          "setting 'core' contradicts filter=%s", shear_filter_name(s->filter));
    }
    if (!isnan(s->width_px) && s->filter == SHEAR_FILTER_NONE)
        return shear_fail(err, SHEAR_E_SETTING, NULL, "setting 'width' contradicts filter=none");
    if (s->background == SHEAR_BACKGROUND_NOISE_MEAN && s->filter == SHEAR_FILTER_NONE) {
        return shear_fail(err, SHEAR_E_SETTING,
                          "without a filter a constant is not seen: leave it at auto",
                          "setting 'background' contradicts filter=none");
    }
    return SHEAR_OK;
}

static int check_methods(const shear_settings *s, shear_error *err) {
    if (s->pedestal > 0 && !shear_interpolation_is_rule(s->interpolation) &&
        !shear_interpolation_is_log(s->interpolation)) {
        return shear_fail(err, SHEAR_E_SETTING, "a pedestal is for the log methods only",
                          "setting 'pedestal' contradicts interpolation=%s",
                          shear_interpolation_name(s->interpolation));
    }
    if (s->shot_noise == SHEAR_SHOT_PLATEAU && s->interpolation != SHEAR_INTERP_NONE &&
        !shear_interpolation_is_rule(s->interpolation)) {
        return shear_fail(err, SHEAR_E_SETTING, "interpolation colours shot noise: set it to none",
                          "setting 'shot-noise' is plateau but interpolation is %s",
                          shear_interpolation_name(s->interpolation));
    }
    if (s->estimator == SHEAR_ESTIMATOR_PDF_SYM_CROSS && !s->noise_correction) {
        return shear_fail(err, SHEAR_E_SETTING, "its cross terms are with the noise stamps",
                          "setting 'estimator' is pdf-sym-cross but noise-correction is off");
    }
    return SHEAR_OK;
}

int shear_settings_check(const shear_settings *s, shear_error *err) {
    static int (*const checks[])(const shear_settings *, shear_error *) = {
        check_ranges, check_oversample, check_filter, check_methods};
    for (size_t i = 0; i < sizeof checks / sizeof checks[0]; i++)
        TRY(checks[i](s, err));
    return SHEAR_OK;
}
