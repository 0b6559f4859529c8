/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear/settings.h: every choice of the measurement, and the one table that describes them.
 *
 * The table drives the command line, the daemon's configuration, JSON jobs, the catalog's header
 * and the manual pages; a setting's name, type, range, default and help are written there and
 * nowhere else. Lengths are in galaxy pixels. Section numbers are those of docs/method.md.
 */
#ifndef SHEAR_SETTINGS_H
#define SHEAR_SETTINGS_H

#include "shear/error.h"

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum shear_preset {
    SHEAR_PRESET_DEFAULT = 0, /* the library's own */
    SHEAR_PRESET_ZHANG2010,   /* the paper's, which were sheard's up to 0.1 */
    SHEAR_N_PRESETS
};

enum shear_interpolation {
    SHEAR_INTERP_AUTO = 0, /* none, where beta is wide enough for it: METHOD section 1 */
    SHEAR_INTERP_NONE,
    SHEAR_INTERP_BILINEAR,
    SHEAR_INTERP_BICUBIC,
    SHEAR_INTERP_SPLINE,
    SHEAR_INTERP_LOG_BILINEAR,
    SHEAR_INTERP_LOG_BICUBIC,
    SHEAR_INTERP_LOG_SPLINE,
    SHEAR_INTERP_PAPER /* none for R_PSF >= 1 px, else log-bicubic */
};

enum shear_filter {
    SHEAR_FILTER_AUTO =
        0,              /* explicit core where given, paper where R_GAL is known, else the smallest
                           core that leaves the file's galaxies whole: METHOD section 2 */
    SHEAR_FILTER_PAPER, /* core = R_G + 4 beta, width = beta */
    SHEAR_FILTER_EDGE,  /* widest core that has fallen to 1e-3 at the edge, width = beta/2 */
    SHEAR_FILTER_NONE,
    SHEAR_FILTER_R_GAL /* paper where R_GAL is known, else none */
};

enum shear_background {
    SHEAR_BACKGROUND_AUTO = 0,  /* NOISE_MEAN with a filter; without one a constant is not seen */
    SHEAR_BACKGROUND_KEEP,      /* as it is */
    SHEAR_BACKGROUND_NOISE_MEAN /* both lose the noise stamp's mean (method.md, 2) */
};

enum shear_zeros {
    SHEAR_ZEROS_SKIP = 0, /* cells and segments that touch a zero become zero */
    SHEAR_ZEROS_FLOOR /* zeros become a tiny positive number: 1e-12 of the stamp's brightest pixel
                       */
};

/* What becomes of a stamp with a pixel that no sky has made: a cosmic ray, a sentinel. */
enum shear_artefacts {
    SHEAR_ARTEFACTS_FLAG = 0, /* it is left out: SHEAR_FLAG_ARTEFACT, SHEAR_FLAG_NOISE_ARTEFACT */
    SHEAR_ARTEFACTS_KEEP      /* it is not looked for */
};

enum shear_shot_noise {
    SHEAR_SHOT_NONE = 0, /* left as it is */
    SHEAR_SHOT_PLATEAU   /* galaxy and noise power lose each their plateau, before T */
};

enum shear_noise_level {
    SHEAR_NOISE_LEVEL_FIELD = 0, /* one factor for a field, from the power at high k */
    SHEAR_NOISE_LEVEL_NONE       /* galaxy and noise stamps have the same noise */
};

/* How a field's shear is made of its stamps. */
enum shear_estimator {
    SHEAR_ESTIMATOR_MEAN = 0, /* the ratio of means (shear/sums.h) */
    SHEAR_ESTIMATOR_PDF_SYM,  /* PDF symmetrization (shear/symmetry.h) */
    /* The same with the cross terms that keep noise from biasing it. The background is never kept
     * with it. */
    SHEAR_ESTIMATOR_PDF_SYM_CROSS
};

typedef struct shear_settings {
    enum shear_preset preset; /* where the others began */
    enum shear_interpolation interpolation;
    int oversample;       /* s, a power of two; 0 = smallest with 1/s < R_PSF/4 */
    double beta_px;       /* scale radius of the target PSF; NaN = by the two below */
    double beta_ratio;    /* beta / R_PSF where beta_px is NaN ... */
    double beta_floor_px; /* ... but at least this; 0 = no floor */
    enum shear_filter filter;
    double core_px;                   /* R_core; NaN = by the filter's rule */
    double width_px;                  /* R_width; NaN = by the filter's rule */
    enum shear_background background; /* what the filter does not see */
    enum shear_zeros zeros;
    double pedestal;        /* added before the log and taken off after the exp; 0 = none */
    double psf_threshold;   /* modes with |W|^2 below this part of its peak hold no information */
    double power_tolerance; /* largest part of the target's power that may lie beyond the cut */
    bool noise_correction;  /* subtract the noise stamp's moments */
    enum shear_noise_level noise_level; /* of the galaxy stamps */
    enum shear_shot_noise shot_noise;
    enum shear_estimator estimator;
    enum shear_artefacts artefacts;
    double bad_value; /* pixels that are this count as not finite; NaN = none are */
} shear_settings;

enum shear_setting_type { SHEAR_T_CHOICE, SHEAR_T_INT, SHEAR_T_DOUBLE, SHEAR_T_BOOL };

typedef struct shear_setting_def {
    const char *name;    /* long name, as in --name and in JSON: "beta-ratio" */
    const char *keyword; /* FITS keyword, at most 8 characters: "BETARAT" */
    enum shear_setting_type type;
    size_t offset;              /* of the member in shear_settings */
    const char *const *choices; /* SHEAR_T_CHOICE: NULL-terminated names, in the enum's order */
    double min, max;            /* inclusive range of numbers */
    bool has_auto;              /* "auto" is a value (0 for ints, NaN for doubles) */
    const char *unit;           /* "px", "" */
    const char *metavar;        /* in usage texts: "PX" */
    const char *help;           /* one line */
    double by_preset[SHEAR_N_PRESETS]; /* its value in each: the default first; auto as a member */
} shear_setting_def;

/* The word for what has_auto is about: "auto", or, where it chooses nothing, "none" (bad-value). */
const char *shear_setting_auto(const shear_setting_def *def);

/* The table, in the order of documentation; *n becomes its length. Static, never freed. */
const shear_setting_def *shear_settings_table(size_t *n);

/* The entry called `name` ('_' and '-' are the same, case matters), or NULL. */
const shear_setting_def *shear_settings_find(const char *name);

/* Set all members to their defaults. */
void shear_settings_init(shear_settings *s);

/* Parse `text` as the value of setting `name` ("auto" where allowed; booleans: true/false, yes/no,
 * on/off, 1/0). The setting `preset`, the first of the table, sets all others; what is set after it
 * overrides it. SHEAR_E_SETTING names the setting, what was given and what is expected. */
int shear_settings_set(shear_settings *s, const char *name, const char *text, shear_error *err);
/* The same where the order must not count (options, a configuration file): a preset is put beneath
 * what has been given, wherever it stands. `given` is the caller's, of every setting of the table;
 * false where nothing has been given yet. */
int shear_settings_give(shear_settings *s, bool *given, const char *name, const char *text,
                        shear_error *err);

/* Write the value as the text that shear_settings_set reads back to the same bits. Returns buf. */
char *shear_settings_format(const shear_settings *s, const shear_setting_def *def, char *buf,
                            size_t size);

/* Members out of their range (where they were not set through shear_settings_set), and
 * contradictions that no single value shows (a core with filter=none, a pedestal without a log
 * method, shot-noise=plateau with an interpolation, cross terms without noise stamps). SHEAR_OK or
 * SHEAR_E_SETTING. */
int shear_settings_check(const shear_settings *s, shear_error *err);

/* The name of an enum value, from the table's choices. Never NULL. */
const char *shear_interpolation_name(enum shear_interpolation interpolation);
const char *shear_filter_name(enum shear_filter filter);
const char *shear_estimator_name(enum shear_estimator estimator);

/* Is the estimator one that needs the terms of every stamp (shear/symmetry.h)? */
bool shear_estimator_is_symmetric(enum shear_estimator estimator);

/* Does the filter see a background that both stamps have? Only with background = keep, and not
 * with pdf-sym-cross, whose cross terms would not average out over one. */
bool shear_settings_keep_background(const shear_settings *s);

/* True for auto and paper, which choose one of the others by the PSF. */
bool shear_interpolation_is_rule(enum shear_interpolation interpolation);

/* True for the three methods that interpolate ln(pixel). */
bool shear_interpolation_is_log(enum shear_interpolation interpolation);

#ifdef __cplusplus
}
#endif

#endif
