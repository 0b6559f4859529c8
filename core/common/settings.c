/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Set and format settings by name and as text, and check that they do not contradict each other. */
#include "shear/settings.h"

#include "base/cleanup.h"
#include "base/spelling.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Return a setting as a number, which holds the values of all types exactly. */
static double get(const shear_settings *s, const shear_setting_def *def) {
    const void *at = (const char *)s + def->offset;
    switch (def->type) {
    case SHEAR_T_BOOL:
        return *(const bool *)at ? 1.0 : 0.0;
    case SHEAR_T_DOUBLE:
        return *(const double *)at;
    default:
        return *(const int *)at;
    }
}

static void put(shear_settings *s, const shear_setting_def *def, double value) {
    void *at = (char *)s + def->offset;
    switch (def->type) {
    case SHEAR_T_BOOL:
        *(bool *)at = value != 0.0;
        break;
    case SHEAR_T_DOUBLE:
        *(double *)at = value;
        break;
    default:
        *(int *)at = (int)value;
        break;
    }
}

/* Set all settings to a preset's values. */
static void apply_preset(shear_settings *s, enum shear_preset preset) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    memset(s, 0, sizeof *s);
    for (size_t i = 0; i < n; i++)
        put(s, &table[i], table[i].by_preset[preset]);
}

void shear_settings_init(shear_settings *s) {
    apply_preset(s, SHEAR_PRESET_DEFAULT);
}

/* Return whether a number is the value for the word shear_setting_auto. */
static bool is_auto(const shear_setting_def *def, double value) {
    return def->type == SHEAR_T_INT ? def->has_auto && value == 0.0 : isnan(value);
}

static bool in_range(const shear_setting_def *def, double value) {
    int n = 0;
    switch (def->type) {
    case SHEAR_T_CHOICE:
        while (def->choices[n] != NULL)
            n++;
        return value >= 0.0 && value < n;
    case SHEAR_T_BOOL:
        return true;
    default:
        return (def->has_auto && is_auto(def, value)) || (value >= def->min && value <= def->max);
    }
}

static int parse_choice(double *value, const shear_setting_def *def, const char *text,
                        shear_error *err) {
    char known[200];
    const int found = spelling_find(def->choices, text);
    if (found >= 0) {
        *value = found;
        return SHEAR_OK;
    }
    text_list(known, sizeof known, def->choices);
    return shear_fail(err, SHEAR_E_SETTING, NULL, "setting '%s': '%s' is not one of: %s", def->name,
                      text, known);
}

static int parse_bool(double *value, const shear_setting_def *def, const char *text,
                      shear_error *err) {
    bool flag = false;
    if (text_to_bool(text, &flag)) {
        *value = flag ? 1.0 : 0.0;
        return SHEAR_OK;
    }
    return shear_fail(err, SHEAR_E_SETTING, NULL, "setting '%s': '%s' is neither true nor false",
                      def->name, text);
}

static int parse_number(double *value, const shear_setting_def *def, const char *text,
                        shear_error *err) {
    const bool whole = def->type == SHEAR_T_INT;
    int64_t n = 0;
    if (def->has_auto && strcmp(text, shear_setting_auto(def)) == 0) {
        *value = whole ? 0.0 : NAN;
        return SHEAR_OK;
    }
    const bool parsed = whole ? text_to_int64(text, &n) : text_to_double(text, value);
    *value = whole ? (double)n : *value;
    if (parsed && *value >= def->min && *value <= def->max)
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_SETTING, NULL,
                      "setting '%s': '%s' is not %s from %g to %g%s%s%s%s", def->name, text,
                      whole ? "a whole number" : "a number", def->min, def->max,
                      def->unit[0] != '\0' ? " " : "", def->unit, def->has_auto ? ", or " : "",
                      def->has_auto ? shear_setting_auto(def) : "");
}

static bool is_preset(const shear_setting_def *def) {
    return def->offset == offsetof(shear_settings, preset);
}

int shear_settings_set(shear_settings *s, const char *name, const char *text, shear_error *err) {
    const shear_setting_def *def = shear_settings_find(name);
    double value = NAN;
    if (def == NULL) {
        return shear_fail(err, SHEAR_E_SETTING, "the settings are listed in shearctl(1)",
                          "there is no setting '%s'", name);
    }
    TRY(def->type == SHEAR_T_CHOICE ? parse_choice(&value, def, text, err)
        : def->type == SHEAR_T_BOOL ? parse_bool(&value, def, text, err)
                                    : parse_number(&value, def, text, err));
    if (is_preset(def)) {
        apply_preset(s, (enum shear_preset)value);
    } else {
        put(s, def, value);
    }
    return SHEAR_OK;
}

int shear_settings_give(shear_settings *s, bool *given, const char *name, const char *text,
                        shear_error *err) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    const shear_settings before = *s;
    TRY(shear_settings_set(s, name, text, err));
    const shear_setting_def *def = shear_settings_find(name);
    for (size_t i = 0; is_preset(def) && i < n; i++) {
        if (given[i] && !is_preset(&table[i]))
            put(s, &table[i], get(&before, &table[i]));
    }
    given[def - table] = true;
    return SHEAR_OK;
}

char *shear_settings_format(const shear_settings *s, const shear_setting_def *def, char *buf,
                            size_t size) {
    const double value = get(s, def);
    if (def->type == SHEAR_T_CHOICE) {
        text_set(buf, size, def->choices[(int)value]);
    } else if (def->type == SHEAR_T_BOOL) {
        text_set(buf, size, value != 0.0 ? "true" : "false");
    } else if (is_auto(def, value)) {
        text_set(buf, size, shear_setting_auto(def));
    } else if (def->type == SHEAR_T_INT) {
        snprintf(buf, size, "%d", (int)value);
    } else {
        snprintf(buf, size, "%.*g", text_digits(value, 1), value);
    }
    return buf;
}

/* Check values that were set directly, not through shear_settings_set. */
static int check_ranges(const shear_settings *s, shear_error *err) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++) {
        if (!in_range(&table[i], get(s, &table[i]))) {
            return shear_fail(err, SHEAR_E_SETTING, NULL, "setting '%s' is out of range",
                              table[i].name);
        }
    }
    return SHEAR_OK;
}

static bool is_power_of_two(int n) {
    return n > 0 && (n & (n - 1)) == 0;
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
