/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/settings.h
 * All settings of the measurement, and the one table that describes them.
 *
 * The table drives the command line, the daemon's configuration, JSON jobs, the catalog's header
 * and the manual pages; a setting's name, type, range, default and help are written there and
 * nowhere else. Lengths are in galaxy pixels. Sections are those of docs/method.md. A
 * shear_settings is plain data: it may be copied.
 */
#ifndef SHEAR_SETTINGS_H
#define SHEAR_SETTINGS_H

#include "shear/error.h"
#include "shear/linkage.h"

#include <stdbool.h>
#include <stddef.h>

SHEAR_BEGIN_C

/** Sets of values for all settings. */
enum shear_preset {
    SHEAR_PRESET_DEFAULT = 0, /**< the library's defaults */
    SHEAR_PRESET_ZHANG2010,   /**< those of the paper, which were the defaults of versions up to 0.1
                               */
    SHEAR_N_PRESETS           /**< number of presets */
};

/** How pixels are interpolated to the fine grid (docs/method.md section 1). */
enum shear_interpolation {
    SHEAR_INTERP_AUTO = 0,     /**< none if beta is wide enough for it, else log-bicubic */
    SHEAR_INTERP_NONE,         /**< not at all */
    SHEAR_INTERP_BILINEAR,     /**< bilinear */
    SHEAR_INTERP_BICUBIC,      /**< bicubic */
    SHEAR_INTERP_SPLINE,       /**< bicubic spline */
    SHEAR_INTERP_LOG_BILINEAR, /**< the logarithm, bilinear */
    SHEAR_INTERP_LOG_BICUBIC,  /**< the logarithm, bicubic */
    SHEAR_INTERP_LOG_SPLINE,   /**< the logarithm, bicubic spline */
    SHEAR_INTERP_PAPER         /**< none for R_PSF >= 1 px, else log-bicubic */
};

/** How stamps are filtered (docs/method.md section 2). */
enum shear_filter {
    SHEAR_FILTER_AUTO = 0, /**< an explicit core if one is given, paper if R_GAL is known, else the
                              smallest core that leaves the file's galaxies whole */
    SHEAR_FILTER_PAPER,    /**< core = R_G + 4 beta, width = beta */
    SHEAR_FILTER_EDGE, /**< the widest core that has fallen to 1e-3 at the edge, width = beta/2 */
    SHEAR_FILTER_NONE, /**< no filter */
    SHEAR_FILTER_R_GAL /**< paper if R_GAL is known, else none */
};

/** How a background is removed (docs/method.md section 2). */
enum shear_background {
    /** NOISE_MEAN with a filter; without one a constant has no effect. */
    SHEAR_BACKGROUND_AUTO = 0,
    SHEAR_BACKGROUND_KEEP,      /**< not at all */
    SHEAR_BACKGROUND_NOISE_MEAN /**< the noise stamp's mean is subtracted from the galaxy stamp, and
                                   its own level from itself */
};

/** How pixels that are 0 are treated before a logarithm. */
enum shear_zeros {
    SHEAR_ZEROS_SKIP = 0, /**< cells and segments that touch a zero become zero */
    SHEAR_ZEROS_FLOOR     /**< zeros become 1e-12 of the stamp's brightest pixel */
};

/** How a stamp with an artefact is treated: a cosmic ray, a hot pixel, a sentinel. */
enum shear_artefacts {
    SHEAR_ARTEFACTS_FLAG = 0, /**< it is left out: SHEAR_FLAG_ARTEFACT, SHEAR_FLAG_NOISE_ARTEFACT */
    SHEAR_ARTEFACTS_KEEP      /**< artefacts are not searched for */
};

/** How the photon noise of the galaxies themselves is treated. */
enum shear_shot_noise {
    SHEAR_SHOT_NONE = 0, /**< not at all */
    SHEAR_SHOT_PLATEAU /**< the plateau of each stamp's power is subtracted from it, before T(k) */
};

/** How the noise of galaxy and noise stamps is compared (docs/method.md section 5). */
enum shear_noise_level {
    SHEAR_NOISE_LEVEL_FIELD = 0, /**< one factor per field, from the power at high k */
    SHEAR_NOISE_LEVEL_NONE       /**< galaxy and noise stamps are taken to have the same noise */
};

/** How a field's shear is computed from its stamps. */
enum shear_estimator {
    SHEAR_ESTIMATOR_MEAN = 0,     /**< the ratio of means (shear/sums.h) */
    SHEAR_ESTIMATOR_PDF_SYM,      /**< PDF symmetrization (shear/symmetry.h) */
    SHEAR_ESTIMATOR_PDF_SYM_CROSS /**< the same with cross terms that remove the bias from noise;
                                     the background is always subtracted */
};

/** The settings of a measurement. */
typedef struct shear_settings {
    enum shear_preset preset;               /**< the preset on which the other values are based */
    enum shear_interpolation interpolation; /**< of the pixels */
    int oversample;    /**< s, a power of two; 0 = smallest with 1/s < R_PSF/4 */
    double beta_px;    /**< scale radius of the target PSF; NaN = by beta_ratio and beta_floor_px */
    double beta_ratio; /**< beta / R_PSF, if beta_px is NaN */
    double beta_floor_px;             /**< the smallest beta, if beta_px is NaN; 0 = none */
    enum shear_filter filter;         /**< of the stamps */
    double core_px;                   /**< R_core of the filter; NaN = by the filter's rule */
    double width_px;                  /**< R_width of the filter; NaN = by the filter's rule */
    enum shear_background background; /**< how it is removed */
    enum shear_zeros zeros;           /**< how they are treated before a logarithm */
    double pedestal; /**< added before the logarithm, subtracted after the exponential; 0 = none */
    double psf_threshold;   /**< modes with |W|^2 below this part of its peak hold no information */
    double power_tolerance; /**< largest part of the target's power that may lie beyond the cut */
    bool noise_correction;  /**< subtract the noise stamp's moments */
    enum shear_noise_level noise_level; /**< of the galaxy stamps */
    enum shear_shot_noise shot_noise;   /**< of the galaxies */
    enum shear_estimator estimator;     /**< of the field's shear */
    enum shear_artefacts artefacts;     /**< how they are treated */
    double bad_value; /**< pixels of this value count as not finite; NaN = there is no such value */
} shear_settings;

/** The type of a setting. */
enum shear_setting_type {
    SHEAR_T_CHOICE, /**< one of several words; an enum in shear_settings */
    SHEAR_T_INT,    /**< int */
    SHEAR_T_DOUBLE, /**< double */
    SHEAR_T_BOOL    /**< bool */
};

/** The description of one setting. */
typedef struct shear_setting_def {
    const char *name;             /**< long name, as in --name and in JSON: "beta-ratio" */
    const char *keyword;          /**< FITS keyword, at most 8 characters: "BETARAT" */
    enum shear_setting_type type; /**< of the member in shear_settings */
    size_t offset;                /**< of the member in shear_settings */
    const char *const *choices;   /**< SHEAR_T_CHOICE: NULL-terminated names, in the enum's order */
    double min;                   /**< smallest number that is allowed */
    double max;                   /**< largest number that is allowed */
    bool has_auto;                /**< "auto" is a valid value (0 for ints, NaN for doubles) */
    const char *unit;             /**< "px", "" */
    const char *metavar;          /**< in usage texts: "PX" */
    const char *help;             /**< one line */
    double by_preset[SHEAR_N_PRESETS]; /**< its value in each preset, by enum shear_preset; auto as
                                          in the member */
} shear_setting_def;

/** Return the word for the value that has_auto allows: "auto", or "none" for bad-value, which
 * chooses nothing. */
const char *shear_setting_auto(const shear_setting_def *def);

/** Return the table, in the order of documentation; *n becomes its length. Static, never freed. */
const shear_setting_def *shear_settings_table(size_t *n);

/** Find the setting called `name` ('_' and '-' are equivalent, case matters), or return NULL. */
const shear_setting_def *shear_settings_find(const char *name);

/** Set all members to their defaults. */
void shear_settings_init(shear_settings *s);

/** Parse `text` as the value of setting `name` ("auto" if allowed; booleans: true/false, yes/no,
 * on/off, 1/0). The setting `preset`, the first of the table, sets all others; later settings
 * override it. SHEAR_E_SETTING names the setting, the given text and what is expected. */
int shear_settings_set(shear_settings *s, const char *name, const char *text, shear_error *err);
/** The same, independent of the order (for options and configuration files): a preset never
 * overrides what has been given. `given` is the caller's memory, with an entry for every setting of
 * the table: all false before the first call. */
int shear_settings_give(shear_settings *s, bool *given, const char *name, const char *text,
                        shear_error *err);

/** Format the value as text that shear_settings_set() parses to the same bits. Return buf. */
char *shear_settings_format(const shear_settings *s, const shear_setting_def *def, char *buf,
                            size_t size);

/** Check the settings. SHEAR_E_SETTING for members out of their range (if they were not set through
 * shear_settings_set()), and for contradictions between settings (a core with filter = none, a
 * pedestal without a log method, shot-noise = plateau with an interpolation, cross terms without
 * noise stamps). */
int shear_settings_check(const shear_settings *s, shear_error *err);

/** Return the name of an interpolation, from the table's choices; "unknown" for any other
 * number. */
const char *shear_interpolation_name(enum shear_interpolation interpolation);
/** Return the name of a filter, likewise. */
const char *shear_filter_name(enum shear_filter filter);
/** Return the name of an estimator, likewise. */
const char *shear_estimator_name(enum shear_estimator estimator);

/** Return whether the estimator needs the terms of every stamp (shear/symmetry.h). */
bool shear_estimator_is_symmetric(enum shear_estimator estimator);

/** Return whether the filter sees a background that both stamps have: only with background = keep,
 * and never with pdf-sym-cross, whose cross terms would not average out over a background. */
bool shear_settings_keep_background(const shear_settings *s);

/** Return true for auto and paper, which choose one of the others by the PSF. */
bool shear_interpolation_is_rule(enum shear_interpolation interpolation);

/** Return true for the three methods that interpolate ln(pixel). */
bool shear_interpolation_is_log(enum shear_interpolation interpolation);

SHEAR_END_C

#endif
