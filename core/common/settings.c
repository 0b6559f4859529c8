/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "shear/settings.h"

#include "common/preset.h"

#include <errno.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const presets[] = {"default", "zhang2010", NULL};
static const char *const interpolations[] = {
    "auto",         "none",        "bilinear",   "bicubic", "spline",
    "log-bilinear", "log-bicubic", "log-spline", "paper",   NULL};
static const char *const filters[] = {"auto", "paper", "edge", "none", "r-gal", NULL};
static const char *const zeros[] = {"skip", "floor", NULL};
static const char *const shot_noises[] = {"none", "plateau", NULL};
static const char *const backgrounds[] = {"auto", "keep", "noise-mean", NULL};
static const char *const noise_levels[] = {"field", "none", NULL};
static const char *const artefacts[] = {"flag", "keep", NULL};
static const char *const estimators[] = {"mean", "pdf-sym", "pdf-sym-cross", NULL};

enum { MAX_OVERSAMPLE = 64 };

#define AT(member) offsetof(shear_settings, member)
static const shear_setting_def table[] = {
    {"preset", "PRESET", SHEAR_T_CHOICE, AT(preset), presets, 0, 0, false, "", "NAME",
     "sets all other settings, and those that are given beside it override it, in any order; "
     "zhang2010: those of the paper"},
    {"interpolation", "INTERP", SHEAR_T_CHOICE, AT(interpolation), interpolations, 0, 0, false, "",
     "METHOD",
     "how pixels are interpolated; auto: none, or log-bicubic where beta is below 1.2 px and "
     "R_PSF below 1 px; paper: none for R_PSF >= 1 px, else log-bicubic"},
    {"oversample", "OVERSAMP", SHEAR_T_INT, AT(oversample), NULL, 1, MAX_OVERSAMPLE, true, "", "S",
     "fine pixels per pixel, a power of two; auto: smallest with 1/S < R_PSF/4"},
    {"beta", "BETA_PX", SHEAR_T_DOUBLE, AT(beta_px), NULL, 1e-3, 1e3, true, "px", "PX",
     "scale radius of the isotropic Gaussian target PSF; auto: beta-ratio times R_PSF, at least "
     "beta-floor"},
    {"beta-ratio", "BETARAT", SHEAR_T_DOUBLE, AT(beta_ratio), NULL, 0.1, 100, false, "", "X",
     "beta in units of R_PSF, where beta is auto"},
    {"beta-floor", "BETAFLR", SHEAR_T_DOUBLE, AT(beta_floor_px), NULL, 0, 1e3, false, "px", "PX",
     "smallest beta, where beta is auto; 0: none"},
    {"filter", "FILTER", SHEAR_T_CHOICE, AT(filter), filters, 0, 0, false, "", "KIND",
     "border filter: paper (core R_G + 4 beta, width beta), edge (widest that ends at the border), "
     "none; r-gal: paper where R_GAL is known, else none; auto: the same, but else the smallest "
     "core "
     "that leaves the file's own galaxies whole"},
    {"core", "CORE_PX", SHEAR_T_DOUBLE, AT(core_px), NULL, 0, 2048, true, "px", "PX",
     "radius within which the filter is 1; auto: by the filter's rule"},
    {"width", "WIDTH_PX", SHEAR_T_DOUBLE, AT(width_px), NULL, 1e-3, 2048, true, "px", "PX",
     "scale of the filter's Gaussian fall beyond the core; auto: by the filter's rule"},
    {"background", "BACKGRND", SHEAR_T_CHOICE, AT(background), backgrounds, 0, 0, false, "", "KIND",
     "a mean background under the filter: noise-mean (the noise stamp's mean is taken off both "
     "stamps before the filter, which would cut an edge into it), or keep; auto: noise-mean with a "
     "filter"},
    {"zeros", "ZEROS", SHEAR_T_CHOICE, AT(zeros), zeros, 0, 0, false, "", "POLICY",
     "zero pixels under a log method: skip (what touches them becomes zero) or floor (they become "
     "tiny)"},
    {"pedestal", "PEDESTAL", SHEAR_T_DOUBLE, AT(pedestal), NULL, 0, DBL_MAX, false, "", "VALUE",
     "added to both stamps before the log and taken off after the exp, for sky-subtracted data"},
    {"psf-threshold", "PSFTHRES", SHEAR_T_DOUBLE, AT(psf_threshold), NULL, 0, 1, false, "", "X",
     "PSF modes with |W|^2 below this part of the peak, and all beyond the first such |k|, are "
     "cut"},
    {"power-tolerance", "POWERTOL", SHEAR_T_DOUBLE, AT(power_tolerance), NULL, 0, 1, false, "", "X",
     "largest part of the target's power that may lie beyond the cut"},
    {"noise-correction", "NOISECOR", SHEAR_T_BOOL, AT(noise_correction), NULL, 0, 0, false, "", "",
     "subtract the noise stamp's moments from the galaxy's"},
    {"noise-level", "NOISELEV", SHEAR_T_CHOICE, AT(noise_level), noise_levels, 0, 0, false, "",
     "KIND",
     "how much noise galaxy stamps have, against noise stamps: field (one factor for a field, read "
     "off their power at high k) or none (as much)"},
    {"shot-noise", "SHOTNOIS", SHEAR_T_CHOICE, AT(shot_noise), shot_noises, 0, 0, false, "", "KIND",
     "shot noise of galaxy and noise stamp: none (left), or plateau (their mean power at |k| > 3/4 "
     "of Nyquist is subtracted; without interpolation only)"},
    {"estimator", "ESTIMAT", SHEAR_T_CHOICE, AT(estimator), estimators, 0, 0, false, "", "KIND",
     "how a field's shear is made of its stamps: mean (the ratio of means), pdf-sym (the shear "
     "that makes the distribution of shapes symmetric) or pdf-sym-cross (the same, unbiased by "
     "noise; with background = noise-mean)"},
    {"artefacts", "ARTEFACT", SHEAR_T_CHOICE, AT(artefacts), artefacts, 0, 0, false, "", "WHAT",
     "stamps with a pixel that is sharper than the PSF can be, or below the sky (cosmic rays, hot "
     "pixels, sentinels), or with a saturated flat top: flag (they are left out), or keep"},
    {"bad-value", "BADVALUE", SHEAR_T_DOUBLE, AT(bad_value), NULL, -1e300, 1e300, true, "", "VALUE",
     "pixels of this value count as NaN: -9999, say; none: there are no such pixels"},
};
enum { N_SETTINGS = sizeof table / sizeof table[0] };

const shear_setting_def *shear_settings_table(size_t *n) {
    *n = N_SETTINGS;
    return table;
}

static bool same_name(const char *a, const char *b) {
    for (; *a != '\0' && *b != '\0'; a++, b++) {
        const int ca = *a == '_' ? '-' : *a;
        const int cb = *b == '_' ? '-' : *b;
        if (ca != cb) {
            return false;
        }
    }
    return *a == *b;
}

const shear_setting_def *shear_settings_find(const char *name) {
    for (size_t i = 0; i < N_SETTINGS; i++) {
        if (same_name(table[i].name, name)) {
            return &table[i];
        }
    }
    return NULL;
}

void shear_settings_init(shear_settings *s) {
    *s = (shear_settings){
        .preset = SHEAR_PRESET_DEFAULT,
        .interpolation = SHEAR_INTERP_AUTO,
        .oversample = 0,
        .beta_px = NAN,
        .beta_ratio = 2.0,
        .beta_floor_px = 1.4,
        .filter = SHEAR_FILTER_AUTO,
        .core_px = NAN,
        .width_px = NAN,
        .background = SHEAR_BACKGROUND_AUTO,
        .zeros = SHEAR_ZEROS_SKIP,
        .pedestal = 0.0,
        .psf_threshold = 1e-8,
        .power_tolerance = 1e-3,
        .noise_correction = true,
        .noise_level = SHEAR_NOISE_LEVEL_FIELD,
        .shot_noise = SHEAR_SHOT_NONE,
        .estimator = SHEAR_ESTIMATOR_MEAN,
        .artefacts = SHEAR_ARTEFACTS_FLAG,
        .bad_value = NAN,
    };
}

const char *shear_setting_auto(const shear_setting_def *def) {
    return def->offset == AT(bad_value) ? "none" : "auto";
}

static void *member(shear_settings *s, const shear_setting_def *def) {
    return (char *)s + def->offset;
}

static const void *const_member(const shear_settings *s, const shear_setting_def *def) {
    return (const char *)s + def->offset;
}

static int set_choice(int *value, const shear_setting_def *def, const char *text,
                      shear_error *err) {
    char known[200] = "";
    for (int i = 0; def->choices[i] != NULL; i++) {
        if (same_name(def->choices[i], text)) {
            *value = i;
            return SHEAR_OK;
        }
        const size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", i > 0 ? ", " : "", def->choices[i]);
    }
    return shear_fail(err, SHEAR_E_SETTING, NULL, "setting '%s': '%s' is not one of: %s", def->name,
                      text, known);
}

static int set_bool(bool *value, const shear_setting_def *def, const char *text, shear_error *err) {
    static const char *const words[] = {"false", "true", "no", "yes", "off", "on", "0", "1"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (strcmp(words[i], text) == 0) {
            *value = i % 2 == 1;
            return SHEAR_OK;
        }
    }
    return shear_fail(err, SHEAR_E_SETTING, NULL, "setting '%s': '%s' is neither true nor false",
                      def->name, text);
}

static int out_of_range(const shear_setting_def *def, const char *text, shear_error *err) {
    return shear_fail(err, SHEAR_E_SETTING, NULL,
                      "setting '%s': '%s' is not %s from %g to %g%s%s%s%s", def->name, text,
                      def->type == SHEAR_T_INT ? "a whole number" : "a number", def->min, def->max,
                      def->unit[0] != '\0' ? " " : "", def->unit, def->has_auto ? ", or " : "",
                      def->has_auto ? shear_setting_auto(def) : "");
}

static int set_int(int *value, const shear_setting_def *def, const char *text, shear_error *err) {
    char *end = NULL;
    errno = 0;
    const long parsed = strtol(text, &end, 10);
    if (end == text || *end != '\0' || errno != 0 || (double)parsed < def->min ||
        (double)parsed > def->max) {
        return out_of_range(def, text, err);
    }
    *value = (int)parsed;
    return SHEAR_OK;
}

static int set_double(double *value, const shear_setting_def *def, const char *text,
                      shear_error *err) {
    char *end = NULL;
    const double parsed = strtod(text, &end);
    if (end == text || *end != '\0' || !(parsed >= def->min) || !(parsed <= def->max)) {
        return out_of_range(def, text, err);
    }
    *value = parsed;
    return SHEAR_OK;
}

static int set_preset(shear_settings *s, const shear_setting_def *def, const char *text,
                      shear_error *err) {
    int preset = SHEAR_PRESET_DEFAULT;
    const int code = set_choice(&preset, def, text, err);
    return code == SHEAR_OK ? preset_apply(s, (enum shear_preset)preset, err) : code;
}

int shear_settings_set(shear_settings *s, const char *name, const char *text, shear_error *err) {
    const shear_setting_def *def = shear_settings_find(name);
    if (def == NULL) {
        return shear_fail(err, SHEAR_E_SETTING, "the settings are listed in shearctl(1)",
                          "there is no setting '%s'", name);
    }
    const bool automatic = def->has_auto && strcmp(text, shear_setting_auto(def)) == 0;
    switch (def->type) {
    case SHEAR_T_CHOICE:
        return def == &table[0] ? set_preset(s, def, text, err)
                                : set_choice(member(s, def), def, text, err);
    case SHEAR_T_BOOL:
        return set_bool(member(s, def), def, text, err);
    case SHEAR_T_INT:
        if (automatic) {
            *(int *)member(s, def) = 0;
            return SHEAR_OK;
        }
        return set_int(member(s, def), def, text, err);
    default:
        if (automatic) {
            *(double *)member(s, def) = NAN;
            return SHEAR_OK;
        }
        return set_double(member(s, def), def, text, err);
    }
}

/* The shortest decimal that strtod reads back to the same double. */
static void format_double(double value, char *buf, size_t size) {
    for (int digits = 1; digits <= DBL_DECIMAL_DIG; digits++) {
        snprintf(buf, size, "%.*g", digits, value);
        if (strtod(buf, NULL) == value) {
            return;
        }
    }
}

char *shear_settings_format(const shear_settings *s, const shear_setting_def *def, char *buf,
                            size_t size) {
    const void *value = const_member(s, def);
    switch (def->type) {
    case SHEAR_T_CHOICE:
        snprintf(buf, size, "%s", def->choices[*(const int *)value]);
        break;
    case SHEAR_T_BOOL:
        snprintf(buf, size, "%s", *(const bool *)value ? "true" : "false");
        break;
    case SHEAR_T_INT:
        if (def->has_auto && *(const int *)value == 0) {
            snprintf(buf, size, "%s", shear_setting_auto(def));
        } else {
            snprintf(buf, size, "%d", *(const int *)value);
        }
        break;
    default:
        if (isnan(*(const double *)value)) {
            snprintf(buf, size, "%s", shear_setting_auto(def));
        } else {
            format_double(*(const double *)value, buf, size);
        }
        break;
    }
    return buf;
}

static bool is_power_of_two(int n) {
    return n > 0 && (n & (n - 1)) == 0;
}

static bool in_range(const shear_settings *s, const shear_setting_def *def) {
    const void *value = const_member(s, def);
    switch (def->type) {
    case SHEAR_T_CHOICE: {
        int n = 0;
        while (def->choices[n] != NULL) {
            n++;
        }
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

/* Values set by hand, not through shear_settings_set. */
static int check_ranges(const shear_settings *s, shear_error *err) {
    for (size_t i = 0; i < N_SETTINGS; i++) {
        if (!in_range(s, &table[i])) {
            return shear_fail(err, SHEAR_E_SETTING, NULL, "setting '%s' is out of range",
                              table[i].name);
        }
    }
    return SHEAR_OK;
}

int shear_settings_check(const shear_settings *s, shear_error *err) {
    if (check_ranges(s, err) != SHEAR_OK) {
        return SHEAR_E_SETTING;
    }
    const bool core_given = !isnan(s->core_px);
    if (s->oversample != 0 && !is_power_of_two(s->oversample)) {
        return shear_fail(err, SHEAR_E_SETTING, NULL,
                          "setting 'oversample': %d is not a power of two", s->oversample);
    }
    if (s->interpolation == SHEAR_INTERP_NONE && s->oversample > 1) {
        return shear_fail(err, SHEAR_E_SETTING,
                          "choose an interpolation, or leave oversample at auto",
                          "setting 'oversample' is %d but interpolation is none", s->oversample);
    }
    if (core_given && s->filter != SHEAR_FILTER_AUTO && s->filter != SHEAR_FILTER_R_GAL) {
        return shear_fail(err, SHEAR_E_SETTING, "a core of your own goes with filter=auto",
                          "setting 'core' contradicts filter=%s", shear_filter_name(s->filter));
    }
    if (!isnan(s->width_px) && s->filter == SHEAR_FILTER_NONE) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "setting 'width' contradicts filter=none");
    }
    if (s->background == SHEAR_BACKGROUND_NOISE_MEAN && s->filter == SHEAR_FILTER_NONE) {
        return shear_fail(err, SHEAR_E_SETTING,
                          "without a filter a constant is not seen: leave it at auto",
                          "setting 'background' contradicts filter=none");
    }
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

const char *shear_interpolation_name(enum shear_interpolation interpolation) {
    return interpolation <= SHEAR_INTERP_PAPER ? interpolations[interpolation] : "unknown";
}

const char *shear_filter_name(enum shear_filter filter) {
    return filter <= SHEAR_FILTER_R_GAL ? filters[filter] : "unknown";
}

const char *shear_estimator_name(enum shear_estimator estimator) {
    return estimator <= SHEAR_ESTIMATOR_PDF_SYM_CROSS ? estimators[estimator] : "unknown";
}

bool shear_estimator_is_symmetric(enum shear_estimator estimator) {
    return estimator == SHEAR_ESTIMATOR_PDF_SYM || estimator == SHEAR_ESTIMATOR_PDF_SYM_CROSS;
}

bool shear_settings_keep_background(const shear_settings *s) {
    return s->background == SHEAR_BACKGROUND_KEEP && s->estimator != SHEAR_ESTIMATOR_PDF_SYM_CROSS;
}

bool shear_interpolation_is_rule(enum shear_interpolation interpolation) {
    return interpolation == SHEAR_INTERP_AUTO || interpolation == SHEAR_INTERP_PAPER;
}

bool shear_interpolation_is_log(enum shear_interpolation interpolation) {
    return interpolation >= SHEAR_INTERP_LOG_BILINEAR && interpolation <= SHEAR_INTERP_LOG_SPLINE;
}
