/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/saturation.h: find the flat top of an object that saturated its detector.
 *
 * It is n pixels that are exactly as bright as the brightest one, more than 2 s above the sky,
 * where at most
 *
 *     L = (m + 2) q/w,    m pixels less than w below the brightest, w = max(3 s, 2 q)
 *
 * are expected from the noise s and the step q between pixel values: n >= 4, and by Poisson's law
 * so many are less likely than 1e-8. q is the smallest difference among the border's pixels, so
 * that photon counts and other integers, which are often equal, are not taken for flat tops. Nor
 * are images whose pixels all come in groups: the value below the brightest must have less than a
 * third as many pixels. */
#pragma once

#include "measure/artefact.h"

/* Return whether there may be a flat top. Fast; never false if saturation_find finds one. `sigma`:
 * the noise stamp's noise per pixel. */
bool saturation_suspected(const artefact_pair *pair, double sigma);

/* Return the first pixel of a flat top; x = -1: there is none. */
artefact saturation_find(const artefact_pair *pair, double sigma);
