/* SPDX-License-Identifier: GPL-3.0-or-later */
/* light.h: an object's light in a chip's pixels, by its Fourier transform in closed form:
 *
 *     exponential disk      (1 + k' G k)^(-3/2)              G = M M', x = M (disk of scale 1)
 *     Moffat PSF            P(sqrt(k' P k)) exp(-sqrt(k' P k))
 *     pixel                 sinc(kx / 2) sinc(ky / 2)
 *
 * in radians per pixel, with the polynomials P of half-integer exponents (Bessel functions K). */
#pragma once

#include "exposure/scene.h"

/* k' Q k = xx kx^2 + 2 xy kx ky + yy ky^2, pixels^2. */
typedef struct quadratic {
    double xx, xy, yy;
} quadratic;

typedef struct light {
    double flux;
    quadratic galaxy; /* zeros: a star */
    quadratic psf;
    enum shear_mock_moffat moffat;
} light;

/* The PSF at a place of the field. */
typedef struct psf_place {
    double fwhm, e1, e2; /* pixels; without the pixel response */
} psf_place;

/* Return the PSF at (dx, dy) pixels from the field's centre. */
psf_place light_psf(const shear_mock_exposure *e, const focal_plane *f, double dx, double dy);
/* Return the light of an object: sheared, seen through its Jacobian and the PSF. */
light light_of(const shear_mock_exposure *e, const scene_object *o, const psf_place *psf);
/* Return the pixel response's transform along one axis. */
double light_pixel(double k);
/* Return the transform of the rest over the flux. */
double light_transform(const light *l, double kx, double ky);
/* Return the distance beyond which the light is below `threshold` per pixel. */
double light_reach(const light *l, double threshold);
