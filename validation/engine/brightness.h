/* SPDX-License-Identifier: GPL-3.0-or-later */
/* brightness.h: the same galaxies, each at many brightnesses, in the same white noise.
 *
 * A galaxy of flux F in noise of sigma is, but for the unit, a galaxy of flux 1 in noise of
 * sigma/F: moments carry the factor F^2. So galaxies and unit noise are drawn once, and every case
 * (a flux for each galaxy, a sigma) is one measurement more.
 */
#ifndef VALIDATION_BRIGHTNESS_H
#define VALIDATION_BRIGHTNESS_H

#include "engine/options.h"

#include "shear/plan.h"

/* Fluxes are drawn from dn/dF ~ F^-slope between 1 and `range`. */
typedef struct brightness {
    double range, slope;
    double sigma; /* of the white noise, a pixel; 0 = none */
} brightness;

/* The flux of a galaxy: a function of seed and index only. */
double brightness_flux(const brightness *b, uint64_t seed, int64_t galaxy);

/* sigma at which a galaxy of flux 1 has this signal-to-noise: the matched filter's, sqrt(sum f^2) /
 * sigma, of the root mean square galaxy among the first 64. */
int brightness_sigma(const shear_mock_spec *spec, double snr, double *sigma, shear_error *err);

typedef struct bright_stamps bright_stamps;

/* `mock` without noise; shear and all. */
int bright_stamps_new(bright_stamps **s, const shear_mock_spec *mock,
                      const shear_settings *settings, int threads, shear_error *err);
void bright_stamps_free(bright_stamps *s);
const shear_plan_info *bright_stamps_plan(const bright_stamps *s);

/* Stamps [first, first+count) in each of n cases: rows [n][count]. */
int bright_stamps_rows(bright_stamps *s, int64_t first, int count, int n, const brightness *cases,
                       shear_row *rows, shear_error *err);

#endif
