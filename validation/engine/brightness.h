/* SPDX-License-Identifier: GPL-3.0-or-later */
/* brightness.h: the same galaxies with many fluxes, in the same white noise.
 *
 * Up to the unit, a galaxy of flux F in noise of sigma is a galaxy of flux 1 in noise of sigma/F,
 * with moments multiplied by F^2. So galaxies and unit noise are drawn once, and each case (a flux
 * for each galaxy, and a sigma) takes only another measurement. */
#pragma once

#include "shear/plan.h"
#include "shear_mocks/mock.h"

#include <stdint.h>

/* The distribution of fluxes, dn/dF ~ F^-slope between 1 and `range`, and the noise. */
typedef struct brightness {
    double range, slope;
    double sigma; /* of the white noise in a pixel; 0: none */
} brightness;

/* Return the flux of a galaxy, a function of seed and index only. */
double brightness_flux(const brightness *b, uint64_t seed, int64_t galaxy);

/* Return the sigma at which a galaxy of flux 1 has this signal-to-noise, sqrt(sum f^2) / sigma
 * (matched filter), for the root mean square of the first 64 galaxies. */
double brightness_sigma(const shear_mock_spec *spec, double snr);

typedef struct brightness_stamps brightness_stamps;

/* Prepare stamps of `mock`, whose noise is ignored. `threads`: 0: all cores. Ends the program on
 * failure. */
brightness_stamps *brightness_stamps_new(const shear_mock_spec *mock,
                                         const shear_settings *settings, int threads);
void brightness_stamps_free(brightness_stamps *s);
double brightness_stamps_beta_px(const brightness_stamps *s);

/* Measure stamps [first, first+count) in each of n cases: rows [n][count]. */
void brightness_stamps_rows(brightness_stamps *s, int64_t first, int count, int n,
                            const brightness *cases, shear_row *rows);
