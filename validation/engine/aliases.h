/* SPDX-License-Identifier: GPL-3.0-or-later */
/* aliases.h: what a stamp that is not interpolated keeps of the galaxies' aliases
 * (docs/method.md, section 1).
 *
 * Over sub-pixel positions the cross terms of a mode and its aliases average out. What is left is
 * the aliases' own power under the target, here as a part of the signal's:
 *
 *   A = int k^2 T sum_a |F(k + 2 pi a)|^2 / int k^2 T |F(k)|^2        |k| < pi, a != (0, 0)
 *
 * T = exp(-beta^2 k^2) / |W|^2, F = f W, f the galaxy's transform, W that of a Gaussian PSF.
 */
#ifndef VALIDATION_ALIASES_H
#define VALIDATION_ALIASES_H

/* |f|^2 at wave number k (per px), averaged over directions; its unit does not matter. */
typedef double power_function(double k, const void *context);

/* A of galaxies of that power; PSF exp(-(x^2/sx^2 + y^2/sy^2)/2), sigma_px = {sx, sy}. */
double aliases_share(double beta_px, const double sigma_px[2], power_function *power,
                     const void *context);

/* An exponential disk of half-light radius *(const double *)half_light_px; 0: a point. */
double disk_power(double k, const void *half_light_px);

#endif
