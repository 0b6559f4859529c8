/* SPDX-License-Identifier: GPL-3.0-or-later */
/* light.h: images of galaxies with disk and bulge, behind a PSF and square pixels, drawn in Fourier
 * space.
 *
 * All transforms have a closed form: an exponential disk of scale h, (1 + k^2 h^2)^(-3/2); a
 * Spergel profile of index nu and scale c, (1 + k^2 c^2)^(-1-nu) (nu = -0.6 is similar to a de
 * Vaucouleurs bulge); a Moffat function, a Bessel function K; a square pixel, two sincs. Modes up
 * to `reach` times the Nyquist frequency of the pixels are added to the pixels' modes, so aliases
 * are the same as by sampling. The image is periodic, with a period of at least twice the stamp.
 *
 * This is independent of the mocks, which paint points, and of the transforms of libshear. */
#pragma once

#include "shear/error.h"

enum light_psf_kind {
    LIGHT_MOFFAT, /* index 3.5; `size` is the full width at half maximum */
    LIGHT_STRUTS  /* a Gaussian core with sigma `size`, and four spikes with 6 % of the light */
};

typedef struct light_psf {
    enum light_psf_kind kind;
    double size; /* px */
    double e[2]; /* the round PSF is sheared by (1 + e1, e2; e2, 1 - e1) */
} light_psf;

/* A galaxy of flux 1, relative to its centre. */
typedef struct light_galaxy {
    double bulge;     /* fraction of the flux */
    double disk_px;   /* h */
    double bulge_px;  /* c */
    double map[2][2]; /* from coordinates of the round galaxy to those on the sky */
} light_galaxy;

/* Scratch memory of one thread for one PSF and one size of stamps. */
typedef struct light light;
/* Create *out. `side` is a power of two, `reach` is even. All lengths are multiplied by `scale`
 * (for a PSF image: its samples per pixel). */
int light_new(light **out, const light_psf *psf, int side, int reach, double scale,
              shear_error *err);
void light_free(light *l);

/* Draw the galaxy at (x, y) px from the stamp's centre ((side-1)/2, (side-1)/2): out [side][side].
 * The flux is 1, except for the part outside the stamp. */
void light_draw(light *l, const light_galaxy *g, double x, double y, double *out);
/* Draw the PSF, including the pixel response, centred on sample [side/2][side/2]. */
void light_draw_psf(light *l, double *out);
