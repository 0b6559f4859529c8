/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/star_stamps.h: the power spectrum of the PSF from stamps of stars.
 *
 * The border's mean is subtracted from each stamp, and the noise's power from its spectrum: the
 * mean of the modes in the four corners, where no well sampled PSF has power. A polynomial in
 * position is fitted to every mode, its degree 0 below 12 stars, 1 below 30, 2 otherwise. Fluxes
 * are such that the stars agree with it where |W|^2 > 0.5; the mode k = 0, which has all of the
 * background's error, is not used but extrapolated. Stars that differ from the fit are left out,
 * and it is repeated. */
#pragma once

#include "survey/psf/internal.h"

/* Append a model for each table with stamps: a column VIGNET or IMAGE, and positions (places.h).
 * None if there is no such table. SHEAR_E_PSF: no star can be used. */
int star_stamps_read(psf_models *p, shear_error *err);
