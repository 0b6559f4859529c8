/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/star_power.h: |W|^2 from the stamp of one star. */
#pragma once

#include "survey/psf/mode_power.h"

typedef struct star_power {
    mode_power modes;
    double *stamp; /* [ny][nx] without its background */
} star_power;

/* Return false if out of memory. */
bool star_power_init(star_power *s, int nx, int ny, int stamp);
void star_power_deinit(star_power *s);

/* Compute power[stamp][stamp] (mode_power_of), 1 at k = 0, of image[ny][nx], which is cut to the
 * stamp around its middle; *level is the power of the noise that has been subtracted, in the same
 * unit. Pixels without weight, not finite, or below -1e29 (SExtractor) are bad. `weights` may be
 * NULL. Return false if the star cannot be used: bad pixels in its middle or in more than a tenth
 * of the stamp, no flux, or a signal-to-noise ratio of the whole stamp below 5. */
bool star_power_of(star_power *s, const double *image, const double *weights, double *power,
                   double *level);

/* Return the power at k = 0 of power[stamp][stamp], extrapolated from the modes around it; NaN if
 * one of them is not positive. */
double star_power_at_zero(const double *power, int stamp);
