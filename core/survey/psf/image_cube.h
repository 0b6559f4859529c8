/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/image_cube.h: read images of a PSF: one, or a cube with a table of their places.
 *
 * Of up to 64 images the nearest to a galaxy is used. Of more, |W|^2 at each mode of a stamp is
 * fitted by a polynomial of degree 3 in position: images themselves could not be interpolated if
 * they are not centred alike, but their power spectra can. */
#pragma once

#include "survey/psf/internal.h"

/* Append the model of the file; none if it holds no image. SHEAR_E_PSF: an image is no PSF
 * (shear_psf_usable). */
int image_cube_read(psf_models *p, shear_error *err);
