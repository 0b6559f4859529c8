/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/saturation.h: the flat top of an object that was brighter than its detector could tell:
 * n pixels that are exactly as bright as the brightest one, more than 2 s above the sky, where
 * noise s and the step q between pixel values let expect
 *
 *     L = (m + 2) q/w,    m pixels less than w below the brightest, w = max(3 s, 2 q)
 *
 * of them at most: n >= 4, and by Poisson's law so many are less likely than 1e-8. q is the
 * smallest difference among the border's pixels, so that counts of photons and other integers,
 * which are often equal, are no flat tops. Nor are images whose pixels all come in groups: the
 * value below the brightest must have less than a third as many pixels.
 */
#ifndef SHEAR_MEASURE_SATURATION_H
#define SHEAR_MEASURE_SATURATION_H

#include "measure/artefact.h"

/* Could there be one? Never false where saturation_find finds one, and quick. `sigma`: the noise
 * stamp's. */
bool saturation_suspected(const artefact_pair *pair, double sigma);

/* The first pixel of a flat top. */
artefact saturation_find(const artefact_pair *pair, double sigma);

#endif
