/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spec.h: values derived from a spec. */
#pragma once

#include "shear_mocks/mock.h"

/* Return the number of point sources of astronomical noise per px^2. */
double spec_noise_density(const shear_mock_spec *s);
/* Return the amplitude of each, in units of a galaxy's points. The galaxy's mean flux density is
 * that of its nominal number of points within pi R_G^2. */
double spec_noise_amplitude(const shear_mock_spec *s);
/* Return the pixel value at the peak of a galaxy's point (of W_A): 1, or the number of photons for
 * which the galaxy is photon_snr times as bright as the background. */
double spec_point_amplitude(const shear_mock_spec *s);
/* Return the number of samples per side of the PSF image. */
int spec_psf_side(const shear_mock_spec *s);
