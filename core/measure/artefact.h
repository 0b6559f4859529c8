/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/artefact.h: find pixels that cannot be sky light: cosmic rays, hot pixels, sentinels.
 *
 * Pixel p of a stamp, measured from the sky, is an artefact if
 *
 *     p - r m > 6.5 s sqrt(1 + r^2/2) sqrt(1 + r m / (5 s)) + 0.03 p + leak * flux + 0.001 peak
 *
 * where m is the smaller of its left-right and below-above means (on the border, the only one that
 * exists; never below the sky), r and leak are those of the PSF (measure/sharpness.h), and s is the
 * noise of a pixel; or if p < -6.6 s - 0.01 peak. The second root accounts for the galaxy's photon
 * noise, assuming that the sky's noise is 5 electrons; it is more in nearly all data. s is the
 * noise stamp's, or the median deviation of the galaxy stamp's border if that is larger. Nothing
 * depends on the galaxy's shape.
 *
 * A border pixel is an artefact, too, if it is that much above r max(4, r^3) q instead of r m,
 * where q is the pixel inside it (half of that factor in the first root). This is the only test in
 * a corner, and the only one for a streak along the border; a star some pixels outside the stamp
 * may be as steep. Noise stamps are tested in the same way, because artefacts in them bias the
 * shear, too.
 *
 * If the noise stamp has no noise, there is no threshold and nothing is found. */
#pragma once

#include "measure/photometry.h"
#include "measure/sharpness.h"

#include <stdbool.h>

/* A stamp pair and its photometry. All pointers are borrowed. */
typedef struct artefact_pair {
    const double *galaxy, *noise; /* [ny][nx], finite */
    int nx, ny;
    const photometry *ph;
    /* brightest pixel of each strip of the galaxy stamp: see photometry_begin */
    const double *strip_most;
} artefact_pair;

/* The place of an artefact; x = -1: there is none. */
typedef struct artefact {
    int x, y;
    bool in_noise;
} artefact;

/* Return whether there may be an artefact, for any PSF (any sharpness of 1 or more). Fast; never
 * false if artefact_find finds one. */
bool artefact_suspected(const artefact_pair *pair, const sharpness *s);

/* Return the worst artefact of the galaxy stamp or, if it has none, of the noise stamp. */
artefact artefact_find(const artefact_pair *pair, const sharpness *s);

/* Return the noise of a pixel of the noise stamp, without the pixel that is farthest from the mean,
 * which may be an artefact. If the others scatter by rounding only, use the border. */
double artefact_sigma(const artefact_pair *pair);
/* Copy the one-pixel border into values [4 SHEAR_MAX_SIDE]; return the number of pixels. */
size_t artefact_border(const double *pixels, int nx, int ny, double *values);
/* Return the first column of strip i, as in photometry_begin. */
int artefact_strip_start(const artefact_pair *pair, int i);
