/* SPDX-License-Identifier: GPL-3.0-or-later */
/* detector.h: what a chip adds to the light: background, noise, defects, saturation. */
#pragma once

#include "shear_mocks/exposure.h"

/* Bits of the mask image. */
enum detector_bit { DETECTOR_COLUMN = 1, DETECTOR_COSMIC = 2, DETECTOR_SATURATED = 4 };

/* Return the variance of a pixel with `light` ADU above the background, ADU^2. */
double detector_variance(const shear_mock_exposure *e, double light);
/* Turn the light of chip `chip` into the image that is read out, and set its mask: image, mask
 * [ny][nx]. Returns false if out of memory. */
bool detector_expose(const shear_mock_exposure *e, int chip, int threads, double *image,
                     uint8_t *mask);
