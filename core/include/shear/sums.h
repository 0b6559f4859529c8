/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear/sums.h: from rows to a field's shear.
 *
 * Rows are summed in fixed blocks of SHEAR_BLOCK consecutive stamps of a file, in stamp order, with
 * compensated (Neumaier) summation. Blocks are joined in an exact accumulator (integers, no
 * rounding), so that the join is associative and commutative: a field's result is the same to the
 * last bit for any number of workers, any chunking, any order of arrival and any sharding along
 * block boundaries.
 *
 * Estimator: g_i = sum w N_i / sum w D (Zhang 2010, eqs. shear12PSF and OSN3), N and D of galaxy
 * minus noise, the noise at its level in the field (docs/method.md, section 5).
 */
#ifndef SHEAR_SUMS_H
#define SHEAR_SUMS_H

#include "shear/error.h"
#include "shear/settings.h"
#include "shear/stamp.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    SHEAR_BLOCK = 16
}; /* stamps in a block; a multiple of 4, so that rotated fours stay together */

/* What a shear is made of, a stamp: the vector x of which sums w x and sums of products w^2 x x'
 * are kept. */
enum shear_component {
    SHEAR_C_N1, /* galaxy minus noise */
    SHEAR_C_N2,
    SHEAR_C_D,
    SHEAR_C_NOISE_N1, /* the noise stamps' own */
    SHEAR_C_NOISE_N2,
    SHEAR_C_NOISE_D,
    SHEAR_C_HIGH_GALAXY, /* power at high k */
    SHEAR_C_HIGH_NOISE,
    SHEAR_N_COMPONENTS
};
enum { SHEAR_N_PRODUCTS = SHEAR_N_COMPONENTS * (SHEAR_N_COMPONENTS + 1) / 2 };

/* The sums that make a shear, g_i = n_i / d: galaxy minus noise, the noise at its level, which is
 * sum w G_hi / sum w N_hi, or 1 without power at high k. `x`: sum w x_i, of a field or a part. */
typedef struct shear_ratio {
    double n1, n2, d, level;
} shear_ratio;
shear_ratio shear_ratio_of(const double x[SHEAR_N_COMPONENTS]);

/* The terms that are summed over the unflagged stamps of a block. */
enum shear_term {
    SHEAR_S_W,                                                /* w */
    SHEAR_S_COMPONENT,                                        /* w x_i, in order */
    SHEAR_S_PRODUCT = SHEAR_S_COMPONENT + SHEAR_N_COMPONENTS, /* w^2 x_i x_j: shear_term_product */
    SHEAR_S_POWER = SHEAR_S_PRODUCT + SHEAR_N_PRODUCTS,       /* w (M20 + M02) */
    SHEAR_S_NOISE_U,                                          /* w noise_u, w noise_v */
    SHEAR_S_NOISE_V,
    SHEAR_S_CORNER_GALAXY, /* w corner_galaxy, w corner_noise */
    SHEAR_S_CORNER_NOISE,
    SHEAR_S_FLUX,        /* flux */
    SHEAR_S_REMOVED,     /* flux_removed */
    SHEAR_S_REMOVED2,    /* flux_removed^2 */
    SHEAR_S_BORDER_MEAN, /* border_mean and its square */
    SHEAR_S_BORDER_MEAN2,
    SHEAR_S_BORDER_VAR, /* border_var and its square */
    SHEAR_S_BORDER_VAR2,
    SHEAR_S_BORDER_NOISE,  /* border_var_noise */
    SHEAR_S_BORDER_STEP_X, /* border_step_x and its square, and so on */
    SHEAR_S_BORDER_STEP_X2,
    SHEAR_S_BORDER_STEP_Y,
    SHEAR_S_BORDER_STEP_Y2,
    SHEAR_S_BORDER_STEP2,
    SHEAR_S_BORDER_STEP4,
    SHEAR_N_TERMS
};

/* The term of w^2 x_i x_j. */
static inline int shear_term_product(int i, int j) {
    const int low = i < j ? i : j;
    const int high = i < j ? j : i;
    return (int)SHEAR_S_PRODUCT + high * (high + 1) / 2 + low;
}

/* The stamp that counts most: the largest w |N1|, w |N2| or w |D| of the unflagged ones. */
typedef struct shear_influence {
    double size;   /* 0 where there is none */
    int64_t stamp; /* its number in its file */
} shear_influence;

/* The sums of one block: plain data, may be copied, stored and sent between processes of one
 * machine. */
typedef struct shear_block_sums {
    int64_t n_stamps;               /* rows added */
    int64_t n_used;                 /* of them unflagged */
    int64_t flagged[SHEAR_N_FLAGS]; /* rows that carry each flag */
    double hi[SHEAR_N_TERMS];       /* the running sums ... */
    double lo[SHEAR_N_TERMS];       /* ... and their compensations: the sum is hi + lo */
    shear_influence top;
} shear_block_sums;

void shear_block_sums_init(shear_block_sums *b);
/* Add one row; call in stamp order. */
void shear_block_sums_add(shear_block_sums *b, const shear_row *row);

/* A field's exact sums. Not thread-safe: one owner at a time. */
typedef struct shear_field_sums shear_field_sums;
int shear_field_sums_new(shear_field_sums **f, shear_error *err);
void shear_field_sums_free(shear_field_sums *f);
void shear_field_sums_add(shear_field_sums *f, const shear_block_sums *b);  /* exact */
void shear_field_sums_join(shear_field_sums *f, const shear_field_sums *g); /* f += g, exact */
/* f -= g, exact, where g is among what was joined to f: f is then as if g had never been, but for
 * the stamp that counts most: where that was g's, it is no longer known (size NaN) until
 * shear_field_sums_set_top tells it. */
void shear_field_sums_subtract(shear_field_sums *f, const shear_field_sums *g);
shear_influence shear_field_sums_top(const shear_field_sums *f);
void shear_field_sums_set_top(shear_field_sums *f, shear_influence top);
/* Exact text form (ASCII, versioned, 10 to 30 KiB); *text is malloc'd, the caller frees it. Reading
 * it back gives the same sums. Sums of version 0.1 are read, too: they have no noise level. Parse
 * errors are SHEAR_E_FORMAT and say which part cannot be right. */
int shear_field_sums_format(const shear_field_sums *f, char **text, shear_error *err);
int shear_field_sums_parse(shear_field_sums **f, const char *text, shear_error *err);

/* Why a field has no shear. */
enum shear_no_shear {
    SHEAR_HAS_SHEAR = 0,
    SHEAR_NO_STAMPS,     /* fewer than 2 are usable */
    SHEAR_NO_WEIGHT,     /* all weights are 0 */
    SHEAR_NO_DIFFERENCE, /* galaxy and noise stamps are the same, but for rounding */
    SHEAR_NO_SIGNAL,     /* sum w D is not 5 sigma of the noise above 0 */
    SHEAR_SWAPPED,       /* the noise stamps have more power than the galaxies', beyond doubt */
    SHEAR_TOO_NARROW,  /* the galaxies are narrower than the PSF, beyond doubt: D < 0 < M20 + M02 */
    SHEAR_NO_SYMMETRY, /* fewer than 16 stamps for the symmetry, or no shear makes them symmetric */
    SHEAR_NOT_FINITE   /* sums beyond the range of double */
};

/* A field's result. Without a shear (`why`), `valid` is false and the shear and its errors are NaN.
 *
 * The noise level alpha: how much more noise power the galaxy stamps have than the noise stamps,
 * read off at high k. The noise stamps' moments count alpha times: g_i = sum w (N_i + (1 - alpha)
 * noise N_i) / sum w (D + (1 - alpha) noise D). 1 where it cannot be known. */
typedef struct shear_result {
    bool valid;
    enum shear_no_shear why;
    enum shear_estimator estimator;
    double g1, g2;
    double g1_err, g2_err; /* 1 sigma: delta method, or jackknife where it was asked for, or the
                              symmetry's own */
    double cov12;          /* covariance of g1 and g2, by the same method */
    double delta_g1_err, delta_g2_err; /* the delta method's, whatever the others are */
    int jackknife;                     /* groups of the jackknife; 0 = delta method */
    int64_t n_stamps, n_used, n_flagged;
    int64_t flagged[SHEAR_N_FLAGS];
    double sum_weight, sum_d; /* sum_d: at the noise level */
    double signal; /* sum_d over what noise alone scatters it by; INFINITY without noise */
    /* Influence. */
    double n_eff;      /* (sum w D)^2 / sum (w D)^2 */
    double top_size;   /* shear_influence.size of that stamp; 0: there is none */
    double top_share;  /* of the stamp that counts most in |sum w D|; NaN: not known */
    int64_t top_stamp; /* its number in its file, -1: none */
    /* The noise level. */
    double noise_level, noise_level_err; /* alpha; NaN: cannot be known */
    double noise_effect;                 /* what alpha - 1 changes sum w D by, as a part of it */
    double noise_shape, noise_shape_err; /* alpha beyond Nyquist over that below it, minus 1: not 0
                                            where the two noises' spectra differ; NaN: not known */
    double high_galaxy; /* the galaxy stamps' mean power at high k, as a variance a pixel; NaN: not
                           looked at */
    double noise_share; /* noise stamps' part of sum w D: sum w noise D / sum w D */
    double mean_flux;   /* of the used stamps */
    double filter_removed;     /* part of the stacked flux that the filter removes ... */
    double filter_removed_err; /* ... and its 1-sigma error */
    double border_excess;      /* mean border pixel, galaxy minus noise ... */
    double border_excess_err;
    double border_rough; /* mean border variance, galaxy minus noise ... */
    double border_rough_err;
    double border_noise_var;                 /* mean border variance of the noise stamps */
    double border_step_x, border_step_x_err; /* mean step across the border: of a gradient that all
                                                have ... */
    double border_step_y, border_step_y_err;
    double border_step2, border_step2_err; /* ... and mean square: of any, or of neighbours */
} shear_result;

/* Where the errors are from: "delta", "jackknife" or "symmetry". */
const char *shear_error_method(const shear_result *r);

/* The field's result with delta-method errors. They contain the noise level's. */
void shear_field_result(const shear_field_sums *f, shear_result *out);

/* The jackknife: N groups of whole consecutive blocks (nearly equal numbers of them), each left out
 * in turn. Call _add for every block of the field in canonical order (file by file, block by
 * block), then _finish, which overwrites errors and covariance of *out. SHEAR_E_SETTING where there
 * are fewer blocks than groups. Thread-compatible. */
typedef struct shear_jackknife shear_jackknife;
int shear_jackknife_new(shear_jackknife **j, int groups, shear_error *err);
void shear_jackknife_free(shear_jackknife *j);
int shear_jackknife_add(shear_jackknife *j, const shear_block_sums *b, shear_error *err);
/* Append all blocks of `other`. All or nothing. */
int shear_jackknife_join(shear_jackknife *j, const shear_jackknife *other, shear_error *err);
int shear_jackknife_finish(const shear_jackknife *j, shear_result *out, shear_error *err);

#ifdef __cplusplus
}
#endif

#endif
