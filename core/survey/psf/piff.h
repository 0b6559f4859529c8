/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/piff.h: read the models of Piff that need no GalSim: PixelGrid with BasisPolynomial.
 *
 * The pickled WCS in the file is never read: u and v are computed from the pointing. */
#pragma once

#include "survey/psf/internal.h"

/* Append the models of the file; none if it is no file of Piff. SHEAR_E_PSF: another kind of
 * model. */
int piff_read(psf_models *p, shear_error *err);
