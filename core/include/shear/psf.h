/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/psf.h
 * Check whether an image is a PSF, and a good one. The limits come from the measurements in
 * docs/method.md section 3.1.
 *
 * An image that can only be a mistake is refused (shear_psf_usable()). A doubtful one is used and
 * reported: in shear_plan_info.psf, for the field's one PSF or a sample of the stamps' own.
 */
#ifndef SHEAR_PSF_H
#define SHEAR_PSF_H

#include "shear/error.h"
#include "shear/linkage.h"

#include <stdint.h>

SHEAR_BEGIN_C

/** The quality of an image. Lengths in galaxy pixels, levels in units of the brightest sample. NaN:
 * the image is too small to measure it. */
typedef struct shear_psf_quality {
    double r_psf_px; /**< shear_psf_radius() */
    /** Mean of the samples at the rim: about as far from the peak as the nearest edge of the image,
     * or as the last samples that are not 0 if all beyond is exactly 0. */
    double border;
    double rim_px;     /**< distance of the rim from the peak */
    double border_err; /**< error of `border`, from `noise` */
    /** The level falls like r^-slope near the rim; about 0 for a pedestal, +INFINITY if the rim is
     * not above 0, NaN if its level is below 3 errors. */
    double border_slope;
    double cut; /**< fraction of the flux beyond the rim, if the level continues so; NaN if slope
                   < 2.2 */
    /** Noise of a sample near the rim over the flux of a pixel-sized sample, per px. */
    double noise;
    double sampling; /**< samples per R_PSF */
    double lowest;   /**< the most negative sample; 0 if there is none */
} shear_psf_quality;

/** Why an image is doubtful. */
enum shear_psf_flaw {
    SHEAR_PSF_PEDESTAL = 0, /**< the border is not 0 and does not decrease */
    SHEAR_PSF_CUT,          /**< the wings are cut off */
    SHEAR_PSF_NOISY,        /**< noise biases the shear */
    SHEAR_PSF_UNDERSAMPLED, /**< too few samples per R_PSF */
    SHEAR_PSF_NEGATIVE,     /**< negative samples */
    SHEAR_N_PSF_FLAWS       /**< number of flaws */
};

/** Estimate |m| from the border; right within a factor of two or three near 2e-3, for galaxies
 * about as large as the PSF. */
double shear_psf_border_bias(const shear_psf_quality *q, double beta_px);
/** Estimate the scatter of m from the noise, likewise; that of c is 0.7 of it. */
double shear_psf_noise_bias(const shear_psf_quality *q, double beta_px);
/** Estimate |m| from the sampling, likewise. */
double shear_psf_sampling_bias(const shear_psf_quality *q, double beta_px);
/** Return the flaws of an image that is carried to beta: bits 1 << enum shear_psf_flaw. */
unsigned shear_psf_flaws(const shear_psf_quality *q, double beta_px);
/** Return "pedestal", "cut", "noisy", "undersampled" or "negative" for enum shear_psf_flaw; NULL
 * for any other number. */
const char *shear_psf_flaw_name(int flaw);

/** Check that the image psf[ny][nx] may be a PSF. SHEAR_E_PSF if it has samples that are not
 * finite, no positive flux, only equal samples, or an edge brighter than exp(-1/2) of its peak (the
 * PSF lies around the corners, in the order of an FFT; at the edge; or on a bright background).
 * Message and advice say which. */
int shear_psf_usable(const double *psf, int nx, int ny, shear_error *err);
/** Measure the quality of psf[ny][nx], with `oversample` samples per galaxy pixel, which need not
 * be a whole number. SHEAR_E_PSF as above. */
int shear_psf_examine(shear_psf_quality *q, const double *psf, int nx, int ny, double oversample,
                      shear_error *err);

/** How the samples of a PSF model lie. */
enum shear_psf_axes {
    SHEAR_PSF_AXES_PIXEL = 0, /**< along x and y of the stamps; the step is in pixels */
    SHEAR_PSF_AXES_SKY,       /**< along u (West) and v (North); the step is in arcsec */
    /** No samples but |W|^2 itself, at the modes of an nx x ny stamp of the same size as the
     * galaxy's: element [jy + ny/2][jx + nx/2] is mode (jx, jy); the step is not used. */
    SHEAR_PSF_AXES_MODES
};

/** Limits. */
enum {
    SHEAR_MAX_PSF_TERMS = 256 /**< the most terms of a model */
};

/** A PSF that is linear in `terms` numbers c that belong to a galaxy: its samples are sum_t c[t]
 * samples[t] (with SHEAR_PSF_AXES_MODES: |W|^2 is). The pixel response is inside. Normalization and
 * position of the peak do not matter. One image is a model of one term, with c = 1. */
typedef struct shear_psf_model {
    int nx;                   /**< columns of a plane, samples */
    int ny;                   /**< rows of a plane, samples */
    int terms;                /**< planes, at least 1 */
    enum shear_psf_axes axes; /**< of the samples */
    double step;           /**< between samples, pixels or arcsec; need not be a whole part of 1 */
    int lanczos;           /**< order n of the Lanczos kernel that interpolates between samples; its
                              transform multiplies that of the samples; 0: none */
    double smoothed_px;    /**< > 0: the samples have been interpolated from pixels by the Lanczos
                              kernel of order 3 of this scale, in pixels, whose transform is divided
                              out (docs/method.md 3.3); with SHEAR_PSF_AXES_PIXEL only */
    const double *samples; /**< [terms][ny][nx] */
} shear_psf_model;

/** Measure the quality of the PSF of a galaxy with these coefficients [model->terms]. `scale`:
 * arcsec per pixel; it is used with SHEAR_PSF_AXES_SKY only. A model of |W|^2 has no phases: its
 * image is taken to be symmetric. SHEAR_E_PSF as of shear_psf_examine(), and for coefficients that
 * are not finite; SHEAR_E_NOMEM. */
int shear_psf_model_examine(shear_psf_quality *q, const shear_psf_model *model, const double *terms,
                            double scale, shear_error *err);
/** Compute R_PSF of such a galaxy alone: shear_psf_radius(). Errors likewise. */
int shear_psf_model_radius(const shear_psf_model *model, const double *terms, double scale,
                           double *r_psf_px, shear_error *err);

/** The quality of one image or several. */
typedef struct shear_psf_summary {
    int64_t looked_at; /**< number of images; 0: nothing is known */
    int64_t unusable;  /**< images that are unusable; the members below are of the others */
    int64_t flawed[SHEAR_N_PSF_FLAWS]; /**< number of images with each flaw */
    /** The worst of each member: the largest |border| with what belongs to it, the largest cut and
     * noise, the smallest sampling, the lowest sample. */
    shear_psf_quality worst;
} shear_psf_summary;
/** Add one image to the summary. q: its quality, or NULL if it is unusable. */
void shear_psf_summary_add(shear_psf_summary *s, const shear_psf_quality *q, double beta_px);

SHEAR_END_C

#endif
