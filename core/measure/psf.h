/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/psf.h: what can be said of a PSF image before it is transformed. */
#ifndef SHEAR_MEASURE_PSF_H
#define SHEAR_MEASURE_PSF_H

#include "shear/error.h"

/* SHEAR_E_PSF where the image [ny][nx] is not finite, or its sum or its brightest sample is not
 * positive. *peak: that sample. */
int psf_check(const double *psf, int nx, int ny, double *peak, shear_error *err);

/* The PSF between its samples: at (x + i/fine, y + j/fine), into out[j fine + i], i and j from 0 to
 * fine - 1; log-bicubic, or where a sample around is not positive, bilinear. Beyond the image its
 * outermost samples go on. */
void psf_refine(const double *psf, int nx, int ny, int x, int y, int fine, double *out);

/* The same at any (x, y), in samples; where a sample around is not positive, the nearest one, or 0.
 */
double psf_at(const double *psf, int nx, int ny, double x, double y);

#endif
