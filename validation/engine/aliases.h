/* SPDX-License-Identifier: GPL-3.0-or-later */
/* aliases.h: the power of aliases in stamps that are not interpolated (docs/method.md section 1).
 *
 * The cross terms of a mode and its aliases average out over sub-pixel positions. What remains is
 * the power of the aliases themselves. As a fraction of the signal's power under the target it is
 *
 *   A = int k^2 T sum_a |F(k + 2 pi a)|^2 / int k^2 T |F(k)|^2        |k| < pi, a != (0, 0)
 *
 * with T = exp(-beta^2 k^2) / |W|^2 and F = f W. f is the galaxy's transform, W that of a Gaussian
 * PSF.
 */
#pragma once

/* Return |f|^2 at wave number k (per px), averaged over directions, in any unit. */
typedef double power_function(double k, const void *context);

/* Return A for galaxies of that power, and a PSF exp(-(x^2/sx^2 + y^2/sy^2)/2), sigma_px = {sx,
 * sy}. */
double aliases_share(double beta_px, const double sigma_px[2], power_function *power,
                     const void *context);

/* The power of an exponential disk of half-light radius *(const double *)half_light_px; 0: a point.
 */
double disk_power(double k, const void *half_light_px);
