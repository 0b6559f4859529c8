/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear/stamp.h: what goes into a measurement (stamp pairs in memory) and what comes out (one row a
 * stamp).
 *
 * Axes: x is the FITS column axis (NAXIS1, index varies fastest), y the row axis. A stamp of nx x
 * ny pixels is an array [ny][nx] of double. Its centre is at ((nx-1)/2, (ny-1)/2).
 */
#ifndef SHEAR_STAMP_H
#define SHEAR_STAMP_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { SHEAR_MIN_SIDE = 8, SHEAR_MAX_SIDE = 1024 }; /* of a stamp, pixels */

/* Why a stamp is left out of the field's sums. A row may carry several. */
enum shear_flag {
    SHEAR_FLAG_GALAXY_NOT_FINITE = 1u << 0, /* a NaN, infinite or BLANK pixel in the galaxy stamp */
    SHEAR_FLAG_NOISE_NOT_FINITE = 1u << 1,  /* the same in the noise stamp */
    SHEAR_FLAG_MASKED = 1u << 2,            /* CATALOG.FLAGS is not zero */
    SHEAR_FLAG_EMPTY = 1u << 3,             /* all pixels of the galaxy stamp are equal */
    SHEAR_FLAG_PSF_UNUSABLE =
        1u << 4, /* this stamp's PSF: not finite, no flux, too wide for beta, bad id */
    SHEAR_FLAG_BAD_WEIGHT = 1u << 5, /* CATALOG.WEIGHT is none (shear_weight_is_good) */
    SHEAR_FLAG_BAD_R_GAL =
        1u << 6, /* the filter needs CATALOG.R_GAL, which is not positive and finite */
    SHEAR_FLAG_OVERFLOW =
        1u << 7, /* the pixels are finite, but the moments, or the sums made of them, are not */
    /* A pixel of the galaxy stamp that no sky has made: sharper than the PSF, below the sky, or one
     * of a saturated flat top (docs/method.md, section 8) */
    SHEAR_FLAG_ARTEFACT = 1u << 8,
    SHEAR_FLAG_NOISE_ARTEFACT = 1u << 9 /* the same in the noise stamp */
};
enum { SHEAR_N_FLAGS = 10 };

/* The stable name of flag bit number `bit` (0..SHEAR_N_FLAGS-1): "galaxy_not_finite", ... NULL
 * beyond. */
const char *shear_flag_name(int bit);
/* One line of explanation for people. NULL beyond. */
const char *shear_flag_help(int bit);

/* A weight is 0, or finite and 1e-100 at least: the errors need squares of weights, which would be
 * lost below. Only the ratios of weights count. */
bool shear_weight_is_good(double weight);

/* Consecutive stamp pairs of one field file. The arrays belong to the caller and are only read.
 * Arrays marked "or NULL" are absent where the file has no such column. */
typedef struct shear_stamps {
    int64_t first;            /* index in the file of the first pair */
    int count;                /* pairs */
    int nx, ny;               /* pixels of a stamp */
    const double *galaxy;     /* [count][ny][nx] */
    const double *noise;      /* [count][noise_planes][ny][nx] */
    int noise_planes;         /* noise stamps a galaxy, >= 1; 0 counts as 1 */
    int n_psf;                /* PSF images in `psf`; 0 where the plan holds the field's one PSF */
    const double *psf;        /* [n_psf][psf_ny][psf_nx], or NULL */
    const int32_t *psf_index; /* [count] index into psf, -1 = the file names no such PSF; or NULL */
    const double *weight;     /* [count], or NULL: all 1 */
    const double *r_gal;      /* [count] R_G of the filter, pixels, or NULL: unknown */
    const int32_t *mask;      /* [count] CATALOG.FLAGS, or NULL: all 0 */
} shear_stamps;

enum { SHEAR_MAX_NOISE_PLANES = 64 };

/* The result for one pair. Moments are noise-corrected (galaxy minus noise; the mean of its noise
 * stamps, where there are several) unless the correction is off, and physical: M20 is the integral
 * of (df/dx)^2 over the plane, in pixel units, whatever the stamp's size or the interpolation; in
 * terms of METHOD's sums over modes they carry the factor 1/(nx ny s^4). A flagged row has NaN in
 * every number that could not be measured. */
typedef struct shear_row {
    double n1, n2, d;         /* -(M20-M02)/2, -M11, M20+M02-(beta^2/2) M4 */
    double u, v;              /* sum (kx^4-6kx^2ky^2+ky^4) P, sum (kx^3 ky-kx ky^3) P */
    double m20, m02, m11, m4; /* sum kx^2 P, ky^2 P, kx ky P, k^4 P */
    /* With estimator = pdf-sym-cross, what is added to n1, n2, d, u, v for the symmetry
     * (docs/method.md, section 6); else 0. */
    double cross_n1, cross_n2, cross_d, cross_u, cross_v;
    /* The same moments of the noise stamp alone: what a noise level other than 1 takes off more
     * (docs/method.md, section 5); u and v as the symmetry wants them, -(beta^2/2) U and
     * -2 beta^2 V. 0 without the correction. */
    double noise_n1, noise_n2, noise_d, noise_u, noise_v;
    /* The mean power of galaxy and noise stamp at the wave numbers where no galaxy has any
     * (shear_plan_info.noise_band), as a variance a pixel of the filtered stamp; and what the modes
     * beyond Nyquist add to that mean. 0 where the noise level is not looked at. */
    double high_galaxy, high_noise;
    double corner_galaxy, corner_noise;
    double flux;             /* sum(galaxy) - sum(noise) */
    double snr;              /* flux / (rms(noise stamp) * sqrt(2 nx ny)); NaN without noise */
    double flux_removed;     /* the part of flux that the filter takes away */
    double border_mean;      /* mean of the one-pixel border, galaxy minus noise */
    double border_var;       /* variance of that border, galaxy minus noise */
    double border_var_noise; /* variance of the noise stamp's border */
    /* The border's right side over its left one and the top over the bottom, means of a pixel,
     * galaxy minus noise; and the sum of the squares of both, likewise. */
    double border_step_x, border_step_y, border_step2;
    double weight;
    int64_t stamp;              /* its number in its file */
    int artefact_x, artefact_y; /* the worst such pixel, from 0; -1: there is none */
    uint32_t flags;             /* or of enum shear_flag; 0 = in the sums */
} shear_row;

#ifdef __cplusplus
}
#endif

#endif
