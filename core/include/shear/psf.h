/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/psf.h
 * Is this image a PSF, and a good one? docs/method.md section 3.1 has the measurements that the
 * limits come from.
 *
 * What can only be a mistake is refused (shear_psf_usable()). What is doubtful is used, and told:
 * shear_plan_info.psf says it of the field's one PSF, or of a sample of the stamps' own.
 */
#ifndef SHEAR_PSF_H
#define SHEAR_PSF_H

#include "shear/error.h"

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What an image says of itself. Lengths in galaxy pixels, levels in units of the brightest sample.
 * NaN: the image is too small to tell. */
typedef struct shear_psf_quality {
    double r_psf_px; /**< shear_psf_radius() */
    double
        border; /**< mean of the samples at the rim: about as far from the peak as the nearest edge
                   of the image or, if all beyond is exactly 0, as the last samples that are not */
    double rim_px;     /**< distance of the rim from the peak */
    double border_err; /**< error of `border`, from `noise` */
    double
        border_slope; /**< near the rim the level falls like r^-slope; about 0 for a pedestal,
                         +INFINITY if the rim is not above 0, NaN if its level is below 3 errors */
    double cut; /**< the part of the flux beyond the rim, if it continues so; NaN if slope < 2.2 */
    double
        noise; /**< a sample's noise near the rim over the flux of a pixel-sized sample, per px */
    double sampling; /**< samples per R_PSF */
    double lowest;   /**< the most negative sample; 0 if none is */
} shear_psf_quality;

/** What makes an image doubtful. */
enum shear_psf_flaw {
    SHEAR_PSF_PEDESTAL = 0, /**< the border is not 0 and does not fall */
    SHEAR_PSF_CUT,          /**< the wings are cut off */
    SHEAR_PSF_NOISY,        /**< noise biases the shear */
    SHEAR_PSF_UNDERSAMPLED, /**< too few samples per R_PSF */
    SHEAR_PSF_NEGATIVE,     /**< negative samples */
    SHEAR_N_PSF_FLAWS       /**< how many there are */
};

/** |m| that the border makes, an estimate that is right within a factor of two or three near 2e-3,
 * for galaxies about as large as the PSF. */
double shear_psf_border_bias(const shear_psf_quality *q, double beta_px);
/** The scatter of m that the noise makes, likewise; that of c is 0.7 of it. */
double shear_psf_noise_bias(const shear_psf_quality *q, double beta_px);
/** |m| that the sampling makes, likewise. */
double shear_psf_sampling_bias(const shear_psf_quality *q, double beta_px);
/** The flaws of an image that is carried to beta: bits 1 << enum shear_psf_flaw. */
unsigned shear_psf_flaws(const shear_psf_quality *q, double beta_px);
/** "pedestal", "cut", "noisy", "undersampled", "negative" for enum shear_psf_flaw; NULL for any
 * other number. */
const char *shear_psf_flaw_name(int flaw);

/** SHEAR_E_PSF if the image psf[ny][nx] cannot be a PSF: samples that are not finite, no positive
 * flux, all samples equal, or an edge of the image brighter than exp(-1/2) of its peak (it lies
 * around the corners, in the order of an FFT; at the edge; or on a bright background). Message and
 * advice say which. */
int shear_psf_usable(const double *psf, int nx, int ny, shear_error *err);
/** What psf[ny][nx], with `oversample` samples per galaxy pixel, says of itself. SHEAR_E_PSF as
 * above.
 */
int shear_psf_examine(shear_psf_quality *q, const double *psf, int nx, int ny, int oversample,
                      shear_error *err);

/** What one image, or several, are like. */
typedef struct shear_psf_summary {
    int64_t looked_at;                 /**< images; 0: nothing is known */
    int64_t unusable;                  /**< of them; the members below are of the others */
    int64_t flawed[SHEAR_N_PSF_FLAWS]; /**< how many have each flaw */
    shear_psf_quality
        worst; /**< the worst of each member: the largest |border| with what belongs to it,
                  the largest cut and noise, the smallest sampling, the lowest sample */
} shear_psf_summary;
/** Count one more image. NULL: an unusable one. */
void shear_psf_summary_add(shear_psf_summary *s, const shear_psf_quality *q, double beta_px);

#ifdef __cplusplus
}
#endif

#endif
