/* SPDX-License-Identifier: GPL-3.0-or-later */
/* methods.h: the paper's six interpolations, and how images are laid out around them. */
#ifndef VALIDATION_METHODS_H
#define VALIDATION_METHODS_H

#include "engine/sample.h"
#include "shear_figures/figure.h"

enum { N_METHODS = 6 };

typedef struct method {
    const char *label; /* "Log-Bicubic" */
    enum shear_interpolation interpolation;
    int plain; /* index of the method without the logarithm; -1 where it is one */
    /* Close to the paper's colours: cyan, blue, magenta, green, red, black. */
    enum shear_hue hue;
    enum shear_marker marker;
} method;
/* In the paper's order: Bilinear, Bicubic, Spline, and the same with Log-. */
extern const method methods[N_METHODS];

/* How the measurement gets the PSF. */
enum psf_sampling { PSF_FINE = 0, PSF_COARSE, N_PSF_SAMPLINGS };
extern const char *const psf_sampling_names[N_PSF_SAMPLINGS];
/* OVERSAMP of a PSF of this radius: a power of two, at least 16 samples in R_PSF (or the most that
 * the mocks can), or 1 where it is as coarse as the galaxies. */
int psf_oversample(enum psf_sampling sampling, double r_psf_px);

/* A side that FFTs like, at least `side`: even, of factors 2, 3, 5. */
int good_side(double side);
/* The side of a stamp that holds a galaxy of R_G and its PSF down to about 1e-10 of its peak. */
int stamp_side(double r_gal_px, double r_psf_px);

/* The series of one method of scene 0; a PSF that is itself interpolated may leave modes without
 * information, so that the tolerance for lost power is lifted there. */
series method_series(int i_method, enum psf_sampling sampling, double r_psf_px,
                     const shear_settings *settings);
/* The series of all methods for both samplings of the PSF, or the first only. */
enum { N_METHOD_SERIES = N_METHODS * N_PSF_SAMPLINGS };
void method_series_all(series all[N_METHOD_SERIES], double r_psf_px,
                       const shear_settings *settings);

#endif
