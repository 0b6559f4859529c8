/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/cutter.h: cut pairs of a galaxy stamp and its noise stamps out of a chip.
 *
 * Both are prepared alike: a plane through an 8 px frame around the stamp is subtracted, and the
 * union of their masks (defects, other objects grown by 3 px) is filled in both with Gaussian noise
 * of the local standard deviation (docs/exposures.md). Random numbers are counted by chip, source
 * and pixel: they depend on nothing else.
 *
 * Notes
 *
 * 1. A galaxy's light is every pixel of its isophote, and every pixel within R = r_gal + 2.6
 *    R_PSF of its position; where r_gal is unknown, R reaches to its farthest pixel and at least to
 *    2.6 R_PSF. For the mock galaxies this is 10 to 12 px, where filled columns changed the shear
 *    by less than 10^-3; at 6 to 9 px it was 6 %.
 *
 * 2. A galaxy is dropped for a neighbour (SHEAR_FLAG_NEIGHBOUR) if
 *    - a pixel of another object, grown by 3 px, lies in its light: the fill would take light away;
 *    - or a pixel of another object, not grown, lies within R + max(3 px, 2 R_PSF) of its position:
 *      what shines beyond the other's isophote would remain in the light, or be taken with it;
 *    - or less than 30 % of the frame is left, for whatever reason but defects.
 *    For two mock galaxies 22 px apart nothing was wrong; at 18 px m is -0.04 to +0.01, at 14 px
 *    -0.05, whatever the radius of the disc that is filled. Where all galaxies have a neighbour
 * like themselves, with isophotes at 2 sigma, those that remain have m = +0.004 at 20 px, +0.001 at
 *    24 px, by the light beyond what is masked.
 *
 * 3. Noise stamps near a galaxy are drawn from all that are free and in reach with the same chance
 *    (noise_boxes.h), whatever their pixels: the quietest ones would be biased. One with a defect
 *    where the galaxy has its light is left out. White noise has no plane to be subtracted. */
#pragma once

#include "shear/stamp.h"
#include "survey/cutout/noise_mesh.h"
#include "survey/pixels/chip_pixels.h"

enum { CUTTER_FRAME = 8 }; /* pixels around a stamp, for its plane */

typedef struct cutter_options {
    int nx, ny;                  /* of the chip, pixels */
    int stamp;                   /* side, pixels */
    int noise_stamps;            /* per galaxy, at least 1; 1 from a noise image */
    enum shear_noise_kind noise; /* where they come from */
    int chip;                    /* number of the chip, for random numbers */
    double r_psf_px;             /* for the light of a galaxy */
    shear_amplifiers amplifiers; /* along an axis with several, each holds CUTTER_FRAME pixels on
                                    both sides of a stamp */
} cutter_options;

typedef struct cutter cutter;
/* Survey the chip for empty boxes, and for its noise; where the weight map gives standard
 * deviations, these are scaled to what is measured. `noise` are the pixels of the noise image, or
 * NULL. All are borrowed. SHEAR_E_SETTING, SHEAR_E_FORMAT: too large; SHEAR_E_NOMEM and errors of
 * reading; *c is NULL on error. */
int cutter_new(cutter **c, chip_pixels *pixels, chip_pixels *noise, const cutter_options *options,
               shear_error *err);
void cutter_free(cutter *c);
/* Return the chip's noise. */
const noise_mesh *cutter_noise(const cutter *c);

/* A galaxy to be cut out. */
typedef struct cutter_source {
    double x, y;   /* pixels, from 0 */
    double r_gal;  /* pixels, 2 FLUX_RADIUS: a radius with most of the light; NaN: unknown */
    int64_t id;    /* for random numbers */
    int32_t owner; /* its pixels' owner; 0: the one at its position */
} cutter_source;
/* What was cut. */
typedef struct cutter_pair {
    double *galaxy; /* [stamp][stamp]; the caller's memory, like the next */
    double *noise;  /* [noise_stamps][stamp][stamp] */
    uint32_t flags; /* SHEAR_FLAG_EDGE, HOLE, SATURATED, NEIGHBOUR, NO_NOISE, NO_POSITION; the
                       stamps are zero with any of them */
    double filled;  /* part of the stamp's pixels that was filled; 0 if flagged */
    double sigma;   /* local standard deviation; NaN: unknown */
    int x, y;       /* first pixel of the stamp, from 0; undefined without a position */
    int n_noise;    /* noise stamps that were cut out of an image: all, none of white noise,
                       and as many as were found with SHEAR_FLAG_NO_NOISE */
    int noise_x[SHEAR_MAX_NOISE_PLANES], noise_y[SHEAR_MAX_NOISE_PLANES]; /* the same of them */
} cutter_pair;
/* Cut one pair: the stamp's pixel [stamp/2][stamp/2] is the nearest to the source. Errors are those
 * of reading; what is wrong with the galaxy is a flag. A galaxy with another flag is not searched
 * noise for. */
int cutter_cut(cutter *c, const cutter_source *source, cutter_pair *pair, shear_error *err);
