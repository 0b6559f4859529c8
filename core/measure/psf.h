/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/psf.h: checks and interpolation of a PSF image. */
#pragma once

#include "shear/error.h"

/* Check the image [ny][nx] and set *peak to its brightest sample. SHEAR_E_PSF if a sample is not
 * finite, or the sum or the peak is not positive. */
int psf_check(const double *psf, int nx, int ny, double *peak, shear_error *err);

/* Interpolate the PSF at (x + i/fine, y + j/fine) into out[j fine + i], i and j from 0 to fine - 1:
 * log-bicubic, or bilinear if a neighbouring sample is not positive. Beyond the image its outermost
 * samples are repeated. */
void psf_refine(const double *psf, int nx, int ny, int x, int y, int fine, double *out);

/* Return the PSF at any (x, y), in samples; if a neighbouring sample is not positive, the nearest
 * one, or 0. */
double psf_at(const double *psf, int nx, int ny, double x, double y);
