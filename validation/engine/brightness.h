/* SPDX-License-Identifier: GPL-3.0-or-later */
/* brightness.h: the same galaxies, each at many brightnesses, in the same white noise.
 *
 * A galaxy of flux F in noise of sigma is, but for the unit, a galaxy of flux 1 in noise of
 * sigma/F: moments carry the factor F^2. So galaxies and unit noise are drawn once, and every case
 * (a flux for each galaxy, a sigma) is one measurement more.
 */
#ifndef VALIDATION_BRIGHTNESS_H
#define VALIDATION_BRIGHTNESS_H

#include "shear/plan.h"
#include "shear_mocks/mock.h"

#include <stdint.h>

/* Fluxes are drawn from dn/dF ~ F^-slope between 1 and `range`. */
typedef struct brightness {
    double range, slope;
    double sigma; /* of the white noise, a pixel; 0 = none */
} brightness;

/* The flux of a galaxy: a function of seed and index only. */
double brightness_flux(const brightness *b, uint64_t seed, int64_t galaxy);

/* sigma at which a galaxy of flux 1 has this signal-to-noise: the matched filter's, sqrt(sum f^2) /
 * sigma, of the root mean square galaxy among the first 64. */
double brightness_sigma(const shear_mock_spec *spec, double snr);

typedef struct brightness_stamps brightness_stamps;

/* `mock` without noise; shear and all. `threads`: 0 = all cores. */
brightness_stamps *brightness_stamps_new(const shear_mock_spec *mock,
                                         const shear_settings *settings, int threads);
void brightness_stamps_free(brightness_stamps *s);
double brightness_stamps_beta_px(const brightness_stamps *s);

/* Stamps [first, first+count) in each of n cases: rows [n][count]. */
void brightness_stamps_rows(brightness_stamps *s, int64_t first, int count, int n,
                            const brightness *cases, shear_row *rows);

#endif
