/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/psf.h: checks and interpolation of a PSF image. */
#pragma once

#include "shear/error.h"

/* An image [ny][nx]; borrowed. Beyond it its outermost samples are repeated. */
typedef struct psf_view {
    const double *psf;
    int nx, ny;
} psf_view;

static inline double psf_sample(const psf_view *v, int x, int y) {
    const int cx = x < 0 ? 0 : x >= v->nx ? v->nx - 1 : x;
    const int cy = y < 0 ? 0 : y >= v->ny ? v->ny - 1 : y;
    return v->psf[(long)cy * v->nx + cx];
}

/* Return the index of the brightest of n samples, the first of equals. */
long psf_brightest(const double *psf, long n);

/* Check the image [ny][nx] and set *peak to its brightest sample. SHEAR_E_PSF if a sample is not
 * finite, or the sum or the peak is not positive. */
int psf_check(const double *psf, int nx, int ny, double *peak, shear_error *err);

/* Interpolate the PSF at (x + i/fine, y + j/fine) into out[j fine + i], i and j from 0 to fine - 1:
 * log-bicubic, or bilinear if a neighbouring sample is not positive. */
void psf_refine(const psf_view *v, int x, int y, int fine, double *out);

/* Return the PSF at any (x, y), in samples; if a neighbouring sample is not positive, the nearest
 * one, or 0. */
double psf_at(const psf_view *v, double x, double y);
