/* SPDX-License-Identifier: GPL-3.0-or-later */
/* light.h: galaxies of disk and bulge behind a PSF and square pixels, drawn in Fourier space.
 *
 * Every part has its transform in closed form: an exponential disk of scale h (1 + k^2 h^2)^(-3/2),
 * a Spergel profile of index nu and scale c (1 + k^2 c^2)^(-1-nu) (nu = -0.6 is close to a de
 * Vaucouleurs bulge), a Moffat function a Bessel function K, a square pixel two sincs. Modes up to
 * `reach` times the pixels' Nyquist frequency are added to the pixels' own, so that aliases are
 * what sampling makes of them. The image repeats at a period of twice the stamp at least.
 *
 * Independent of the mocks, which paint points, and of libshear, whose transforms it does not use.
 */
#ifndef VALIDATION_LIGHT_H
#define VALIDATION_LIGHT_H

#include "shear/error.h"

enum light_psf_kind {
    LIGHT_MOFFAT, /* index 3.5; `size` is its full width at half maximum */
    LIGHT_STRUTS  /* a Gaussian core of `size` (sigma) and four spikes with 6 % of the light */
};

typedef struct light_psf {
    enum light_psf_kind kind;
    double size; /* px */
    double e[2]; /* (1 + e1, e2; e2, 1 - e1) is what the round PSF is sheared by */
} light_psf;

/* A galaxy of flux 1 about its centre. */
typedef struct light_galaxy {
    double bulge;     /* its part of the flux */
    double disk_px;   /* h */
    double bulge_px;  /* c */
    double map[2][2]; /* from the round galaxy's coordinates to those on the sky */
} light_galaxy;

/* Scratch of one thread for one PSF and one size of stamps. */
typedef struct light light;
/* `side` is a power of two, `reach` even. Lengths are `scale` times larger (samples of a PSF image:
 * its samples per pixel). */
int light_new(light **out, const light_psf *psf, int side, int reach, double scale,
              shear_error *err);
void light_free(light *l);

/* The galaxy centred at (x, y) px from the stamp's centre ((side-1)/2, (side-1)/2); flux 1, but for
 * the stamp's edges. out [side][side] */
void light_draw(light *l, const light_galaxy *g, double x, double y, double *out);
/* The PSF, pixel response and all, centred on the sample [side/2][side/2]. */
void light_draw_psf(light *l, double *out);

#endif
