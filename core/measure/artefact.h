/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/artefact.h: pixels that no sky has made: cosmic rays, hot pixels, sentinels.
 *
 * A pixel p of a stamp, above the sky, is one where
 *
 *     p - r m > 6.5 s sqrt(1 + r^2/2) sqrt(1 + r m / (5 s)) + 0.03 p + leak * flux + 0.001 peak
 *
 * m the smaller of its left-right and below-above means (along the border the one there is; never
 * below the sky), r and leak those of the PSF (measure/sharpness.h), s the
 * noise of a pixel; or where p < -6.6 s - 0.01 peak. The second root is the galaxy's own photons,
 * were the sky's noise 5 electrons: it is more in nearly all data. s is that of the noise stamp,
 * or, where the galaxy stamp's border scatters more (median deviation), that. Nothing depends on
 * the galaxy's shape. A border pixel is one, too, where it is that much above r max(4, r^3) q
 * instead of r m, q the pixel inside it (half of that factor in the first root): the one test there
 * is in a corner, and for a streak along the border; a star some pixels outside may be as steep.
 * Noise stamps are looked at alike: what is in them biases, too.
 *
 * Where the noise stamp has no noise there is no threshold, and nothing is found.
 */
#ifndef SHEAR_MEASURE_ARTEFACT_H
#define SHEAR_MEASURE_ARTEFACT_H

#include "measure/photometry.h"
#include "measure/sharpness.h"

#include <stdbool.h>

/* A stamp pair, and what is known of it. */
typedef struct artefact_pair {
    const double *galaxy, *noise; /* [ny][nx], finite */
    int nx, ny;
    const photometry *ph;
    const double *strip_most; /* of the galaxy's strips: see photometry_begin */
} artefact_pair;

/* Where it is; x = -1: there is none. */
typedef struct artefact {
    int x, y;
    bool in_noise;
} artefact;

/* Could there be one, whatever the PSF (any sharpness of 1 or more)? Never false where
 * artefact_find finds one, and quick. */
bool artefact_suspected(const artefact_pair *pair, const sharpness *s);

/* The worst artefact of the galaxy stamp, or, where it has none, of the noise stamp. */
artefact artefact_find(const artefact_pair *pair, const sharpness *s);

/* The noise of a pixel of the noise stamp, the one that is farthest from the mean left out: it may
 * be an artefact. Where it leaves nothing of the others but rounding, the border tells. */
double artefact_sigma(const artefact_pair *pair);
/* The one-pixel border into values [4 SHEAR_MAX_SIDE]; how many. */
size_t artefact_border(const double *pixels, int nx, int ny, double *values);
/* The first column of strip number i, as the photometry has it. */
int artefact_strip_start(const artefact_pair *pair, int i);

#endif
