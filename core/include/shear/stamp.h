/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/stamp.h
 * The input of a measurement (stamp pairs in memory) and its output (one row per stamp).
 *
 * Axes: x is the FITS column axis (NAXIS1, its index varies fastest), y the row axis. A stamp of nx
 * x ny pixels is an array [ny][nx] of double. Its centre is at ((nx-1)/2, (ny-1)/2).
 */
#ifndef SHEAR_STAMP_H
#define SHEAR_STAMP_H

#include "shear/linkage.h"

#include <stdbool.h>
#include <stdint.h>

SHEAR_BEGIN_C

/** Limits of stamps, and of PSF images. */
enum {
    SHEAR_MIN_SIDE = 8,           /**< the shortest side, pixels */
    SHEAR_MAX_SIDE = 1024,        /**< the longest side, pixels */
    SHEAR_MAX_NOISE_PLANES = 64,  /**< the most noise stamps per galaxy */
    SHEAR_MIN_PSF_SIDE = 3,       /**< the shortest side of a PSF image, samples */
    SHEAR_MAX_PSF_SIDE = 4096,    /**< the longest side of a PSF image, samples */
    SHEAR_MAX_PSF_OVERSAMPLE = 64 /**< the most PSF samples per pixel */
};

/** The fewest PSF samples per pixel. */
#define SHEAR_MIN_PSF_OVERSAMPLE 0.1

/** Why a stamp is left out of the field's sums. A row may have several flags. */
enum shear_flag {
    /** A NaN, infinite or BLANK pixel in the galaxy stamp. */
    SHEAR_FLAG_GALAXY_NOT_FINITE = 1u << 0,
    SHEAR_FLAG_NOISE_NOT_FINITE = 1u << 1, /**< the same in the noise stamp */
    SHEAR_FLAG_MASKED = 1u << 2,           /**< CATALOG.FLAGS is not zero */
    SHEAR_FLAG_EMPTY = 1u << 3,            /**< all pixels of the galaxy stamp are equal */
    /** Its PSF is not finite, has no flux, is too wide for beta, or is missing. */
    SHEAR_FLAG_PSF_UNUSABLE = 1u << 4,
    SHEAR_FLAG_BAD_WEIGHT = 1u << 5, /**< CATALOG.WEIGHT is not a weight: shear_weight_is_good() */
    /** The filter needs CATALOG.R_GAL; it is not positive and finite. */
    SHEAR_FLAG_BAD_R_GAL = 1u << 6,
    SHEAR_FLAG_OVERFLOW = 1u << 7, /**< the pixels are finite, but their moments or sums are not */
    /** A pixel of the galaxy stamp that cannot be sky light: sharper than the PSF, below the sky,
     * or in a saturated flat top (docs/method.md section 8). */
    SHEAR_FLAG_ARTEFACT = 1u << 8,
    SHEAR_FLAG_NOISE_ARTEFACT = 1u << 9, /**< the same in the noise stamp */
    /* The flags below are set by a reader of exposures (shear_stamps.flags). */
    SHEAR_FLAG_EDGE = 1u << 10,       /**< the stamp and its frame do not fit into the chip */
    SHEAR_FLAG_HOLE = 1u << 11,       /**< bad pixels lie in the galaxy's light */
    SHEAR_FLAG_SATURATED = 1u << 12,  /**< saturated pixels lie in the galaxy's light */
    SHEAR_FLAG_NEIGHBOUR = 1u << 13,  /**< another object is too near */
    SHEAR_FLAG_NO_NOISE = 1u << 14,   /**< there is no empty sky near the galaxy */
    SHEAR_FLAG_NO_POSITION = 1u << 15 /**< its position is not finite, or not in the image, or has
                                         no place on the sky */
};
/** Flags of stamps that have no coefficients of a PSF model. A reader knows them without pixels. */
enum { SHEAR_FLAGS_WITHOUT_PSF = SHEAR_FLAG_PSF_UNUSABLE | SHEAR_FLAG_NO_POSITION };
/** Numbers of flags. */
enum {
    SHEAR_N_FLAGS = 16 /**< number of flags */
};

/** Return the stable name of flag `bit` (0 .. SHEAR_N_FLAGS-1), such as "galaxy_not_finite"; NULL
 * for any other number. */
const char *shear_flag_name(int bit);
/** Return a line of explanation for flag `bit`; NULL for any other number. */
const char *shear_flag_help(int bit);

/** Return whether a weight is 0, or finite and at least 1e-100: the errors need squares of weights,
 * which would underflow below that. Only the ratios of weights matter. */
bool shear_weight_is_good(double weight);

/** Consecutive stamp pairs of one field. The arrays belong to the caller and are only read. */
typedef struct shear_stamps {
    int64_t first;        /**< number in the field of the first pair, from 0 */
    int count;            /**< pairs */
    int nx;               /**< columns of a stamp, pixels */
    int ny;               /**< rows of a stamp, pixels */
    const double *galaxy; /**< [count][ny][nx] */
    const double *noise;  /**< [count][noise_planes][ny][nx] */
    int noise_planes;     /**< noise stamps per galaxy; 0 counts as 1 */
    /** [count][4] du/dx, du/dy, dv/dx, dv/dy at each galaxy, arcsec per pixel, (u, v) on the sky;
     * or NULL. A plan of a sky frame needs them: its moments are along u and v. */
    const double *jacobian;
    const uint32_t *flags; /**< [count] flags that the reader has found, or NULL: none */
    /** [count][terms] coefficients of the plan's PSF models, or NULL if it has none; psf_index is
     * then the number of the model. */
    const double *psf_terms;
    int n_psf;                /**< PSF images in `psf`; 0 if the plan holds the field's one PSF */
    const double *psf;        /**< [n_psf][psf_ny][psf_nx], or NULL */
    const int32_t *psf_index; /**< [count] index into psf, -1: there is no such PSF; or NULL: image
                                 i for pair i */
    const double *weight;     /**< [count], or NULL: all 1 */
    const double *r_gal;      /**< [count] R_G for the filter, pixels, or NULL: unknown */
    const int32_t *mask;      /**< [count] not 0: the stamp is left out; or NULL: all 0 */
} shear_stamps;

/** The axes of moments and shears. */
enum shear_frame {
    SHEAR_FRAME_PIXEL = 0, /**< x along the columns, y along the rows */
    SHEAR_FRAME_SKY, /**< x to the West, y to the North: the convention of GalSim and TreeCorr */
    SHEAR_FRAME_SKY_EAST /**< x to the East, y to the North: the sign of g2 is the other one */
};
/** Numbers of frames. */
enum {
    SHEAR_N_FRAMES = 3 /**< number of frames */
};
/** Return "pixel", "sky" or "sky-east"; "unknown" for any other number. */
const char *shear_frame_name(enum shear_frame frame);

/** The result for one pair. Moments are noise-corrected (galaxy minus the mean of its noise stamps)
 * unless the correction is off, and in physical units: M20 is the integral of (df/dx)^2 over the
 * plane, in pixel units, independent of the stamp's size and the interpolation; that is 1/(nx ny
 * s^4) of the sums over modes in docs/method.md section 4. P is the power after the transfer. A
 * flagged row has NaN in every number that could not be measured. */
typedef struct shear_row {
    double n1;       /**< -(M20 - M02) / 2 */
    double n2;       /**< -M11 */
    double d;        /**< M20 + M02 - (beta^2/2) M4 */
    double u;        /**< sum (kx^4 - 6 kx^2 ky^2 + ky^4) P */
    double v;        /**< sum (kx^3 ky - kx ky^3) P */
    double m20;      /**< sum kx^2 P */
    double m02;      /**< sum ky^2 P */
    double m11;      /**< sum kx ky P */
    double m4;       /**< sum k^4 P */
    double cross_n1; /**< with estimator = pdf-sym-cross, the amount added to n1 for the symmetry
                        (docs/method.md section 6); else 0 */
    double cross_n2; /**< the same for n2 */
    double cross_d;  /**< the same for d */
    double cross_u;  /**< the same for u */
    double cross_v;  /**< the same for v */
    double noise_n1; /**< n1 of the noise stamp alone, of which a noise level other than 1 subtracts
                        more (docs/method.md section 5); 0 without the correction */
    double noise_n2; /**< the same for n2 */
    double noise_d;  /**< the same for d */
    double noise_u;  /**< the same, as the symmetry needs it: -(beta^2/2) u */
    double noise_v;  /**< the same, as the symmetry needs it: -2 beta^2 v */
    double d_err; /**< 1 sigma that noise would give d, were this a point source that is as bright
                     (docs/method.md section 5.1); NaN without the correction */
    double high_galaxy;      /**< mean power of the galaxy stamp in shear_plan_info.noise_band, as a
                                variance per pixel of the filtered stamp; 0 without a band */
    double high_noise;       /**< the same of the noise stamp */
    double corner_galaxy;    /**< contribution of the modes beyond Nyquist to high_galaxy */
    double corner_noise;     /**< contribution of the modes beyond Nyquist to high_noise */
    double flux;             /**< sum(galaxy) - sum(noise) */
    double snr;              /**< flux / (rms(noise stamp) * sqrt(2 nx ny)); NaN without noise */
    double flux_removed;     /**< the part of flux that the filter removes */
    double border_mean;      /**< mean of the one-pixel border, galaxy minus noise */
    double border_var;       /**< variance of that border, galaxy minus noise */
    double border_var_noise; /**< variance of the noise stamp's border */
    double border_step_x;   /**< the border's right side minus its left one, means per pixel, galaxy
                               minus noise */
    double border_step_y;   /**< the same, top minus bottom */
    double border_step2;    /**< sum of the squares of both steps, galaxy minus noise */
    double weight;          /**< its weight; 1 if none was given */
    int64_t stamp;          /**< its number in its field, from 0 */
    int artefact_x;         /**< column of the worst artefact, from 0; -1: none */
    int artefact_y;         /**< row of the worst artefact, from 0; -1: none */
    enum shear_frame frame; /**< axes of the moments; k is in radians per arcsec on the sky */
    uint32_t flags;         /**< bits of enum shear_flag; 0 = in the sums */
} shear_row;

SHEAR_END_C

#endif
