/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/psf.h: what can be said of a PSF image before it is transformed. */
#ifndef SHEAR_MEASURE_PSF_H
#define SHEAR_MEASURE_PSF_H

#include "shear/error.h"

/* SHEAR_E_PSF where the image [ny][nx] is not finite, or its sum or its brightest sample is not
 * positive. *peak: that sample. */
int psf_check(const double *psf, int nx, int ny, double *peak, shear_error *err);

#endif
