/* SPDX-License-Identifier: GPL-3.0-or-later */
/* methods.h: the paper's six interpolations, and the sizes of stamps and PSF images for them. */
#pragma once

#include "engine/sample.h"
#include "shear_figures/figure.h"

enum { N_METHODS = 6 };

typedef struct method {
    const char *label; /* "Log-Bicubic" */
    enum shear_interpolation interpolation;
    int plain; /* index of the method without the logarithm; -1: this one is without */
    /* Close to the colours of the paper: cyan, blue, magenta, green, red, black. */
    enum shear_hue hue;
    enum shear_marker marker;
} method;
/* In the paper's order: Bilinear, Bicubic, Spline, and the same with a logarithm. */
extern const method methods[N_METHODS];

/* The sampling of the PSF image that is measured. */
enum psf_sampling { PSF_FINE = 0, PSF_COARSE, N_PSF_SAMPLINGS };
extern const char *const psf_sampling_names[N_PSF_SAMPLINGS];
/* Return OVERSAMP for a PSF of this radius: a power of two with at least 16 samples per R_PSF (or
 * the maximum of the mocks), or 1 if the PSF is sampled like the galaxies. */
int psf_oversample(enum psf_sampling sampling, double r_psf_px);

/* Return the next size suitable for FFTs, at least `side`: even, with factors 2, 3, 5. */
int good_side(double side);
/* Return the side of a stamp that contains a galaxy of R_G and its PSF down to about 1e-10 of the
 * peak. */
int stamp_side(double r_gal_px, double r_psf_px);

/* Return the series of one method for scene 0. If the PSF is interpolated too, modes may have no
 * information; the tolerance for lost power is then lifted. */
series method_series(int i_method, enum psf_sampling sampling, double r_psf_px,
                     const shear_settings *settings);
/* The series of all methods, for both samplings of the PSF or only the first. */
enum { N_METHOD_SERIES = N_METHODS * N_PSF_SAMPLINGS };
void method_series_all(series all[N_METHOD_SERIES], double r_psf_px,
                       const shear_settings *settings);
