/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/psf_model.h: images of a galaxy's PSF, from a model and its coefficients. */
#pragma once

#include "measure/psf.h"
#include "measure/sharpness.h"
#include "shear/psf.h"

#include <stdbool.h>
#include <stddef.h>

/* Add up the planes: image[ny][nx] = sum_t c[t] samples[t]. */
void psf_model_sum(const double *samples, int terms, size_t size, const double *c, double *image);

/* Draw the image [ny][nx]: the sum of the planes or, of a model of |W|^2, the symmetric image of
 * its root, with one sample per pixel. Return false if out of memory. */
bool psf_model_draw(const shear_psf_model *m, const double *c, double *image);

/* Return the samples per pixel, with pixels of `scale` arcsec. */
double psf_model_sampling(const shear_psf_model *m, double scale);
