/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/cutter.h: cut pairs of a galaxy stamp and its noise stamps out of a chip.
 *
 * Both are prepared alike: a plane through an 8 px frame around the stamp is subtracted, and the
 * union of their masks (defects, other objects grown) is filled in both with Gaussian noise of the
 * local standard deviation (docs/exposures.md). Random numbers are counted by chip, source and
 * pixel: they depend on nothing else. */
#pragma once

#include "survey/pixels/chip_pixels.h"

typedef struct cutter_options {
    int stamp;                   /* side, pixels */
    int noise_stamps;            /* per galaxy, at least 1 */
    enum shear_noise_kind noise; /* where they come from */
    int chip;                    /* number of the chip, for random numbers */
    double r_psf_px;             /* for the light of a galaxy: r_gal + 2.6 r_psf_px */
    int split_x;                 /* column of the second amplifier, from 0; 0: one amplifier */
} cutter_options;

typedef struct cutter cutter;
/* Survey the chip for empty boxes, and for its noise where sigma is unknown. `noise` are the pixels
 * of the noise image, or NULL. All are borrowed. SHEAR_E_*, *c is NULL on error. */
int cutter_new(cutter **c, chip_pixels *pixels, chip_pixels *noise, const cutter_options *options,
               shear_error *err);
void cutter_free(cutter *c);

/* A galaxy to be cut out. */
typedef struct cutter_source {
    double x, y;   /* pixels, from 0 */
    double r_gal;  /* pixels; NaN: unknown */
    int64_t id;    /* for random numbers */
    int32_t owner; /* its pixels' owner; 0: the one at its position */
} cutter_source;
/* What was cut. */
typedef struct cutter_pair {
    double *galaxy;       /* [stamp][stamp]; the caller's memory, like the next */
    double *noise;        /* [noise_stamps][stamp][stamp] */
    uint32_t flags;       /* SHEAR_FLAG_EDGE, HOLE, SATURATED, NEIGHBOUR, NO_NOISE, NO_POSITION; the
                             stamps are zero with most of them */
    double filled;        /* part of the stamp's pixels that was filled */
    double sigma;         /* local standard deviation */
    int x, y;             /* first pixel of the stamp, from 0 */
    int noise_x, noise_y; /* the same of the first noise stamp */
} cutter_pair;
/* Cut one pair: the stamp's pixel [stamp/2][stamp/2] holds the source's position. Errors are those
 * of reading; what is wrong with the galaxy is a flag. */
int cutter_cut(cutter *c, const cutter_source *source, cutter_pair *pair, shear_error *err);
