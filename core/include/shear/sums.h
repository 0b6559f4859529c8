/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/sums.h
 * From rows to a field's shear.
 *
 * Rows are summed in fixed blocks of SHEAR_BLOCK consecutive stamps of a file, in stamp order, with
 * compensated (Neumaier) summation. Blocks are added to an exact accumulator (integers, no
 * rounding), so that addition is associative and commutative: a field's result is the same to the
 * last bit for any number of workers, any chunking, any order of arrival and any sharding along
 * block boundaries.
 *
 * Estimator: g_i = sum w N_i / sum w D, eqs. (5) and (8) of Zhang (2010), N and D of galaxy minus
 * noise, the noise at its level in the field (docs/method.md section 5).
 */
#ifndef SHEAR_SUMS_H
#define SHEAR_SUMS_H

#include "shear/error.h"
#include "shear/linkage.h"
#include "shear/settings.h"
#include "shear/stamp.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SHEAR_BEGIN_C

/** Sizes of sums. */
enum {
    SHEAR_BLOCK = 16 /**< stamps in a block; a multiple of 4, so that rotated fours stay together */
};

/** The components of a shear, per stamp: the vector x, of which the sums of w x and of the products
 * w^2 x x' are kept. */
enum shear_component {
    SHEAR_C_N1,          /**< N1 of galaxy minus noise */
    SHEAR_C_N2,          /**< N2 of galaxy minus noise */
    SHEAR_C_D,           /**< D of galaxy minus noise */
    SHEAR_C_NOISE_N1,    /**< N1 of the noise stamps */
    SHEAR_C_NOISE_N2,    /**< N2 of the noise stamps */
    SHEAR_C_NOISE_D,     /**< D of the noise stamps */
    SHEAR_C_HIGH_GALAXY, /**< power at high k of the galaxy stamp */
    SHEAR_C_HIGH_NOISE,  /**< power at high k of the noise stamps */
    SHEAR_N_COMPONENTS   /**< number of components */
};
/** Numbers of products. */
enum {
    SHEAR_N_PRODUCTS = SHEAR_N_COMPONENTS * (SHEAR_N_COMPONENTS + 1) / 2 /**< of two components */
};

/** The sums that give a shear, g_i = n_i / d: galaxy minus noise, the noise at its level. */
typedef struct shear_ratio {
    double n1;    /**< sum w N1 */
    double n2;    /**< sum w N2 */
    double d;     /**< sum w D */
    double level; /**< sum w G_high / sum w N_high, or 1 without power at high k */
} shear_ratio;
/** Compute the ratio from the sums x = sum w x_i, of a field or a part of it. */
shear_ratio shear_ratio_of(const double x[SHEAR_N_COMPONENTS]);

/** The terms that are summed over the unflagged stamps of a block. */
enum shear_term {
    SHEAR_S_W,         /**< w */
    SHEAR_S_COMPONENT, /**< w x_i, in the order of enum shear_component */
    /** w^2 x_i x_j: shear_term_product(). */
    SHEAR_S_PRODUCT = SHEAR_S_COMPONENT + SHEAR_N_COMPONENTS,
    SHEAR_S_POWER = SHEAR_S_PRODUCT + SHEAR_N_PRODUCTS, /**< w (M20 + M02) */
    SHEAR_S_NOISE_U,                                    /**< w noise_u */
    SHEAR_S_NOISE_V,                                    /**< w noise_v */
    SHEAR_S_CORNER_GALAXY,                              /**< w corner_galaxy */
    SHEAR_S_CORNER_NOISE,                               /**< w corner_noise */
    SHEAR_S_FLUX,                                       /**< flux */
    SHEAR_S_REMOVED,                                    /**< flux_removed */
    SHEAR_S_REMOVED2,                                   /**< flux_removed^2 */
    SHEAR_S_BORDER_MEAN,                                /**< border_mean */
    SHEAR_S_BORDER_MEAN2,                               /**< border_mean^2 */
    SHEAR_S_BORDER_VAR,                                 /**< border_var */
    SHEAR_S_BORDER_VAR2,                                /**< border_var^2 */
    SHEAR_S_BORDER_NOISE,                               /**< border_var_noise */
    SHEAR_S_BORDER_STEP_X,                              /**< border_step_x */
    SHEAR_S_BORDER_STEP_X2,                             /**< border_step_x^2 */
    SHEAR_S_BORDER_STEP_Y,                              /**< border_step_y */
    SHEAR_S_BORDER_STEP_Y2,                             /**< border_step_y^2 */
    SHEAR_S_BORDER_STEP2,                               /**< border_step2 */
    SHEAR_S_BORDER_STEP4,                               /**< border_step2^2 */
    SHEAR_S_BRIGHT,         /**< 1 for a bright stamp: one whose D noise changes little */
    SHEAR_S_SHARP,          /**< 1 for a bright stamp that is sharper than its PSF: D < 0 */
    SHEAR_S_BRIGHT_TRIPLES, /**< triples of bright stamps in a block */
    SHEAR_S_SHARP_TRIPLES,  /**< triples of sharp stamps in a block */
    SHEAR_N_TERMS           /**< number of terms */
};

/** Return the term of w^2 x_i x_j. */
static inline int shear_term_product(int i, int j) {
    const int low = i < j ? i : j;
    const int high = i < j ? j : i;
    return (int)SHEAR_S_PRODUCT + high * (high + 1) / 2 + low;
}

/** The stamp that counts most: the largest w |N1|, w |N2| or w |D| of the unflagged stamps. */
typedef struct shear_influence {
    double size;   /**< 0 if there is no such stamp; NaN if unknown */
    int64_t stamp; /**< its number in its file */
} shear_influence;

/** Return whether the row is unflagged, has weight, and noise changes D little: were it a point
 * source, by less than 2 % of M20 + M02 (docs/method.md section 5.1). */
bool shear_row_is_bright(const shear_row *row);
/** Return whether such a row is sharper than its PSF, by 3 errors of D and 2 % of M20 + M02. */
bool shear_row_is_sharp(const shear_row *row);

/** The sums of one block. Plain data: it may be copied, stored and sent between processes of one
 * machine. */
typedef struct shear_block_sums {
    int64_t n_stamps;               /**< rows added */
    int64_t n_used;                 /**< rows without a flag */
    int64_t flagged[SHEAR_N_FLAGS]; /**< rows that carry each flag */
    int64_t framed[SHEAR_N_FRAMES]; /**< rows of each frame */
    double hi[SHEAR_N_TERMS];       /**< by enum shear_term: the running sums ... */
    double lo[SHEAR_N_TERMS];       /**< ... and their compensations: a sum is hi + lo */
    shear_influence top;            /**< the stamp that counts most */
} shear_block_sums;

/** Set the sums to 0. */
void shear_block_sums_init(shear_block_sums *b);
/** Add one row. Rows must be added in stamp order. */
void shear_block_sums_add(shear_block_sums *b, const shear_row *row);

/** A field's exact sums. Not thread-safe: one owner at a time. */
typedef struct shear_field_sums shear_field_sums;
/** Allocate sums that are 0; *f is NULL on error. */
int shear_field_sums_new(shear_field_sums **f, shear_error *err);
/** Free the sums. NULL is accepted. */
void shear_field_sums_free(shear_field_sums *f);
/** Compute f += b, exactly. */
void shear_field_sums_add(shear_field_sums *f, const shear_block_sums *b);
/** Compute f += g, exactly. */
void shear_field_sums_join(shear_field_sums *f, const shear_field_sums *g);
/** Compute f -= g, exactly, if g is among the sums that were joined to f: f is then as if g had
 * never been joined, except for the stamp that counts most. If that was one of g's, it is unknown
 * (size NaN) until shear_field_sums_set_top(). */
void shear_field_sums_subtract(shear_field_sums *f, const shear_field_sums *g);
/** Return the frame of the stamps; SHEAR_N_FRAMES if they have several, which no shear can have. */
int shear_field_sums_frame(const shear_field_sums *f);
/** Return the stamp that counts most. */
shear_influence shear_field_sums_top(const shear_field_sums *f);
/** Set the stamp that counts most. */
void shear_field_sums_set_top(shear_field_sums *f, shear_influence top);
/** Format the sums as text (ASCII, versioned, 10 to 30 KiB), exactly. *text is malloc'd, and the
 * caller frees it. */
int shear_field_sums_format(const shear_field_sums *f, char **text, shear_error *err);
/** Parse sums from their text. Sums of version 0.1 are accepted, too; they have no noise level.
 * SHEAR_E_FORMAT names the part that cannot be right. *f is NULL on error. */
int shear_field_sums_parse(shear_field_sums **f, const char *text, shear_error *err);

/** Why a field has no shear. */
enum shear_no_shear {
    SHEAR_HAS_SHEAR = 0, /**< it has one */
    SHEAR_NO_STAMPS,     /**< fewer than 2 are usable */
    SHEAR_NO_WEIGHT,     /**< all weights are 0 */
    SHEAR_NO_DIFFERENCE, /**< galaxy and noise stamps are the same, except for rounding */
    SHEAR_NO_SIGNAL,     /**< sum w D is not at least 5 sigma of the noise above 0 */
    SHEAR_SWAPPED,     /**< the noise stamps have significantly more power than the galaxy stamps */
    SHEAR_TOO_NARROW,  /**< the galaxies are significantly narrower than the PSF: D < 0 < M20 + M02
                        */
    SHEAR_NO_SYMMETRY, /**< fewer than 16 stamps for PDF symmetrization, or no shear makes them
                          symmetric */
    SHEAR_NO_FRAME,    /**< stamps were measured along different axes (enum shear_frame) */
    SHEAR_NOT_FINITE   /**< sums overflow the range of double */
};

/** A field's result. If the field has no shear (`why`), `valid` is false and the shear and its
 * errors are NaN.
 *
 * The noise level alpha is the noise power of the galaxy stamps over that of the noise stamps,
 * measured at high k. The noise stamps' moments count alpha times: g_i = sum w (N_i + (1 - alpha)
 * noise N_i) / sum w (D + (1 - alpha) noise D). alpha counts as 1 if it is unknown. */
typedef struct shear_result {
    bool valid;                     /**< the field has a shear */
    enum shear_no_shear why;        /**< why it has none */
    enum shear_estimator estimator; /**< the estimator of the shear */
    double g1;                      /**< the shear along the axes; > 0 stretches along x */
    double g2;                      /**< the shear along the diagonals */
    double g1_err; /**< 1 sigma of g1, by the delta method, the jackknife if one was requested, or
                      the symmetry */
    double g2_err; /**< 1 sigma of g2, likewise */
    double cov12;  /**< covariance of g1 and g2, by the same method */
    double delta_g1_err; /**< 1 sigma of g1 by the delta method, whatever the others are */
    double delta_g2_err; /**< 1 sigma of g2 by the delta method */
    int jackknife;       /**< groups of the jackknife; 0 = none */
    int64_t n_stamps;    /**< rows */
    int64_t n_used;      /**< rows without a flag */
    int64_t n_flagged;   /**< rows with a flag */
    int64_t flagged[SHEAR_N_FLAGS]; /**< rows that carry each flag */
    double sum_weight;              /**< sum w */
    double sum_d;                   /**< sum w D, at the noise level */
    double signal;          /**< sum_d over its scatter from noise alone; INFINITY without noise */
    double n_eff;           /**< effective number of equal stamps: (sum w D)^2 / sum (w D)^2 */
    double top_size;        /**< shear_influence.size of the stamp that counts most; 0: none */
    double top_share;       /**< its share of |sum w D|; NaN: unknown */
    int64_t top_stamp;      /**< its number in its file; -1: none */
    double noise_level;     /**< alpha; NaN: unknown */
    double noise_level_err; /**< its 1 sigma */
    double noise_effect;    /**< relative change of sum w D by alpha - 1 */
    double noise_shape; /**< alpha beyond Nyquist over that below it, minus 1: not 0 if the spectra
                           of the two noises differ; NaN: unknown */
    double noise_shape_err; /**< its 1 sigma */
    double high_galaxy; /**< the galaxy stamps' mean power at high k, as a variance per pixel; NaN:
                           not measured */
    double noise_share; /**< the noise stamps' fraction of sum w D: sum w noise D / sum w D */
    double mean_flux;   /**< of the used stamps */
    int64_t n_bright;   /**< bright stamps: were they point sources, noise would make D an error of
                           less than 2 % of M20 + M02 (docs/method.md section 5.1) */
    int64_t n_sharp; /**< of these those that are sharper than their PSF, by 3 errors of D and 2 %
                        of M20 + M02 */
    int64_t bright_triples; /**< triples of bright stamps in a block of SHEAR_BLOCK stamps */
    int64_t sharp_triples;  /**< triples of sharp stamps in such a block: on a chip whose PSF is
                               wrong they come together */
    double resolution; /**< sum w D / sum w (M20 + M02), at the noise level: 0 for point sources,
                          1 - beta^2/(beta^2 + s^2) for galaxies of radius s, < 0 for what is
                          sharper than its PSF */
    double filter_removed;     /**< fraction of the stacked flux that the filter removes */
    double filter_removed_err; /**< its 1 sigma */
    double border_excess;      /**< mean border pixel, galaxy minus noise */
    double border_excess_err;  /**< its 1 sigma */
    double border_rough;       /**< mean border variance, galaxy minus noise */
    double border_rough_err;   /**< its 1 sigma */
    double border_noise_var;   /**< mean border variance of the noise stamps */
    double border_step_x;      /**< mean step across the border in x, from a gradient common to all
                                  stamps */
    double border_step_x_err;  /**< its 1 sigma */
    double border_step_y;      /**< mean step across the border in y */
    double border_step_y_err;  /**< its 1 sigma */
    double border_step2;       /**< mean square of the step, from any gradient or from neighbouring
                                  objects */
    double border_step2_err;   /**< its 1 sigma */
} shear_result;

/** Return the method of the errors: "delta", "jackknife" or "symmetry". */
const char *shear_error_method(const shear_result *r);

/** Compute the field's result by the ratio of means, with errors by the delta method, which include
 * that of the noise level. */
void shear_field_result(const shear_field_sums *f, shear_result *out);

/** A jackknife: groups of whole consecutive blocks (nearly equal numbers of them), each left out in
 * turn. Not thread-safe: one owner at a time. */
typedef struct shear_jackknife shear_jackknife;
/** Begin a jackknife with so many groups, at least 2; *j is NULL on error. */
int shear_jackknife_new(shear_jackknife **j, int groups, shear_error *err);
/** Free the jackknife. NULL is accepted. */
void shear_jackknife_free(shear_jackknife *j);
/** Add a block. All blocks of the field must be added in canonical order: file by file, block by
 * block. */
int shear_jackknife_add(shear_jackknife *j, const shear_block_sums *b, shear_error *err);
/** Append all blocks of `other`: all or none. */
int shear_jackknife_join(shear_jackknife *j, const shear_jackknife *other, shear_error *err);
/** Overwrite errors and covariance of *out, which shear_field_result() has filled in.
 * SHEAR_E_SETTING if there are fewer blocks than groups. */
int shear_jackknife_finish(const shear_jackknife *j, shear_result *out, shear_error *err);

SHEAR_END_C

#endif
