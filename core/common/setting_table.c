/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The one table that describes the settings, and the names of their choices. */
#include "shear/settings.h"

#include "base/spelling.h"

#include <float.h>
#include <math.h>

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
#define BY_PRESET(usual, zhang2010)                                                                \
    { (usual), (zhang2010) } /* in the order of `presets` */
static const shear_setting_def table[] = {
    {"preset", "PRESET", SHEAR_T_CHOICE, AT(preset), presets, 0, 0, false, "", "NAME",
     "sets all other settings, and those that are given beside it override it, in any order; "
     "zhang2010: those of the paper",
     BY_PRESET(SHEAR_PRESET_DEFAULT, SHEAR_PRESET_ZHANG2010)},
    {"interpolation", "INTERP", SHEAR_T_CHOICE, AT(interpolation), interpolations, 0, 0, false, "",
     "METHOD",
     "how pixels are interpolated; auto: none, or log-bicubic where beta is below 1.2 px and "
     "R_PSF below 1 px; paper: none for R_PSF >= 1 px, else log-bicubic",
     BY_PRESET(SHEAR_INTERP_AUTO, SHEAR_INTERP_PAPER)},
    {"oversample", "OVERSAMP", SHEAR_T_INT, AT(oversample), NULL, 1, MAX_OVERSAMPLE, true, "", "S",
     "fine pixels per pixel, a power of two; auto: smallest with 1/S < R_PSF/4", BY_PRESET(0, 0)},
    {"beta", "BETA_PX", SHEAR_T_DOUBLE, AT(beta_px), NULL, 1e-3, 1e3, true, "px", "PX",
     "scale radius of the isotropic Gaussian target PSF; auto: beta-ratio times R_PSF, at least "
     "beta-floor",
     BY_PRESET(NAN, NAN)},
    {"beta-ratio", "BETARAT", SHEAR_T_DOUBLE, AT(beta_ratio), NULL, 0.1, 100, false, "", "X",
     "beta in units of R_PSF, where beta is auto", BY_PRESET(2.0, 1.5)},
    {"beta-floor", "BETAFLR", SHEAR_T_DOUBLE, AT(beta_floor_px), NULL, 0, 1e3, false, "px", "PX",
     "smallest beta, where beta is auto; 0: none", BY_PRESET(1.4, 0.0)},
    {"filter", "FILTER", SHEAR_T_CHOICE, AT(filter), filters, 0, 0, false, "", "KIND",
     "border filter: paper (core R_G + 4 beta, width beta), edge (widest that ends at the border), "
     "none; r-gal: paper where R_GAL is known, else none; auto: the same, but else the smallest "
     "core that leaves the file's own galaxies whole",
     BY_PRESET(SHEAR_FILTER_AUTO, SHEAR_FILTER_R_GAL)},
    {"core", "CORE_PX", SHEAR_T_DOUBLE, AT(core_px), NULL, 0, 2048, true, "px", "PX",
     "radius within which the filter is 1; auto: by the filter's rule", BY_PRESET(NAN, NAN)},
    {"width", "WIDTH_PX", SHEAR_T_DOUBLE, AT(width_px), NULL, 1e-3, 2048, true, "px", "PX",
     "scale of the filter's Gaussian fall beyond the core; auto: by the filter's rule",
     BY_PRESET(NAN, NAN)},
    {"background", "BACKGRND", SHEAR_T_CHOICE, AT(background), backgrounds, 0, 0, false, "", "KIND",
     "a mean background under the filter: noise-mean (the noise stamp's mean is taken off both "
     "stamps before the filter, which would cut an edge into it), or keep; auto: noise-mean with a "
     "filter",
     BY_PRESET(SHEAR_BACKGROUND_AUTO, SHEAR_BACKGROUND_KEEP)},
    {"zeros", "ZEROS", SHEAR_T_CHOICE, AT(zeros), zeros, 0, 0, false, "", "POLICY",
     "zero pixels under a log method: skip (what touches them becomes zero) or floor (they become "
     "tiny)",
     BY_PRESET(SHEAR_ZEROS_SKIP, SHEAR_ZEROS_SKIP)},
    {"pedestal", "PEDESTAL", SHEAR_T_DOUBLE, AT(pedestal), NULL, 0, DBL_MAX, false, "", "VALUE",
     "added to both stamps before the log and taken off after the exp, for sky-subtracted data",
     BY_PRESET(0.0, 0.0)},
    {"psf-threshold", "PSFTHRES", SHEAR_T_DOUBLE, AT(psf_threshold), NULL, 0, 1, false, "", "X",
     "PSF modes with |W|^2 below this part of the peak, and all beyond the first such |k|, are "
     "cut",
     BY_PRESET(1e-8, 1e-8)},
    {"power-tolerance", "POWERTOL", SHEAR_T_DOUBLE, AT(power_tolerance), NULL, 0, 1, false, "", "X",
     "largest part of the target's power that may lie beyond the cut", BY_PRESET(1e-3, 1e-3)},
    {"noise-correction", "NOISECOR", SHEAR_T_BOOL, AT(noise_correction), NULL, 0, 0, false, "", "",
     "subtract the noise stamp's moments from the galaxy's", BY_PRESET(true, true)},
    {"noise-level", "NOISELEV", SHEAR_T_CHOICE, AT(noise_level), noise_levels, 0, 0, false, "",
     "KIND",
     "how much noise galaxy stamps have, against noise stamps: field (one factor for a field, read "
     "off their power at high k) or none (as much)",
     BY_PRESET(SHEAR_NOISE_LEVEL_FIELD, SHEAR_NOISE_LEVEL_NONE)},
    {"shot-noise", "SHOTNOIS", SHEAR_T_CHOICE, AT(shot_noise), shot_noises, 0, 0, false, "", "KIND",
     "shot noise of galaxy and noise stamp: none (left), or plateau (their mean power at |k| > 3/4 "
     "of Nyquist is subtracted; without interpolation only)",
     BY_PRESET(SHEAR_SHOT_NONE, SHEAR_SHOT_NONE)},
    {"estimator", "ESTIMAT", SHEAR_T_CHOICE, AT(estimator), estimators, 0, 0, false, "", "KIND",
     "how a field's shear is made of its stamps: mean (the ratio of means), pdf-sym (the shear "
     "that makes the distribution of shapes symmetric) or pdf-sym-cross (the same, unbiased by "
     "noise; with background = noise-mean)",
     BY_PRESET(SHEAR_ESTIMATOR_MEAN, SHEAR_ESTIMATOR_MEAN)},
    {"artefacts", "ARTEFACT", SHEAR_T_CHOICE, AT(artefacts), artefacts, 0, 0, false, "", "WHAT",
     "stamps with a pixel that is sharper than the PSF can be, or below the sky (cosmic rays, hot "
     "pixels, sentinels), or with a saturated flat top: flag (they are left out), or keep",
     BY_PRESET(SHEAR_ARTEFACTS_FLAG, SHEAR_ARTEFACTS_KEEP)},
    {"bad-value", "BADVALUE", SHEAR_T_DOUBLE, AT(bad_value), NULL, -1e300, 1e300, true, "", "VALUE",
     "pixels of this value count as NaN: -9999, say; none: there are no such pixels",
     BY_PRESET(NAN, NAN)},
};
enum { N_SETTINGS = sizeof table / sizeof table[0] };

const shear_setting_def *shear_settings_table(size_t *n) {
    *n = N_SETTINGS;
    return table;
}

const shear_setting_def *shear_settings_find(const char *name) {
    for (size_t i = 0; i < N_SETTINGS; i++) {
        if (spelling_same(table[i].name, name))
            return &table[i];
    }
    return NULL;
}

const char *shear_setting_auto(const shear_setting_def *def) {
    return def->offset == AT(bad_value) ? "none" : "auto";
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
