/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/sky_scene.h: Gaussian galaxies and PSFs on the sky, drawn on pixels of any Jacobian.
 */
#pragma once

#include "gaussian.h"

#include "shear/plan.h"

enum { SCENE_SIDE = 64, SCENE_PSF_SIDE = 81 };

/* Sizes on the sky in arcsec; fluxes are those of the Gaussians' amplitudes. */
typedef struct sky_scene {
    gaussian galaxy, psf;    /* (u, v) to the West and the North */
    double jacobian[4];      /* du/dx, du/dy, dv/dx, dv/dy, arcsec per pixel */
    double shift_x, shift_y; /* of the galaxy from the middle of its stamp, pixels */
    double pixels[SCENE_SIDE * SCENE_SIDE], noise[SCENE_SIDE * SCENE_SIDE];
    double samples[SCENE_PSF_SIDE * SCENE_PSF_SIDE]; /* of the PSF */
} sky_scene;

/* A scene of an elongated galaxy and PSF on pixels of `scale` arcsec, turned by `angle` radians,
 * mirrored (East to the right) if so, and sheared by (g1, g2) in the pixels' axes. The PSF has two
 * samples per pixel. */
void sky_scene_init(sky_scene *s, double scale, double angle, bool mirrored, double g1, double g2);
/* Draw the stamps. */
void sky_scene_draw(sky_scene *s);
/* Draw the PSF on the pixels' axes with this step (pixels), or on the sky's (arcsec), its peak
 * (x, y) samples off the middle. */
void sky_scene_draw_psf(sky_scene *s, double step, double x, double y);
void sky_scene_draw_sky_psf(sky_scene *s, double step, double x, double y);
/* Return the Gaussian on pixels: J^-1 C J^-T, with its flux. */
gaussian sky_scene_on_pixels(const sky_scene *s, const gaussian *g);
double sky_scene_pixel_scale(const sky_scene *s);

/* What a measurement of the scene is made of. */
typedef struct sky_way {
    enum shear_frame frame;
    const shear_psf_model *model; /* NULL: the PSF is an image of ... */
    double oversample;            /* ... this many samples per pixel */
    const double *terms;          /* coefficients of the model; NULL: 0.37 for its one term */
    bool typical;                 /* the plan is told the coefficients */
    bool own_psf;                 /* the image belongs to the stamp */
    const char *estimator;        /* NULL: mean */
    const char *shot_noise;       /* NULL: none */
    double beta_px;
    const double *jacobian; /* NULL: the scene's */
    uint32_t flags;         /* those of the reader */
} sky_way;
/* Plan and measure; the plan's decisions go to *info unless it is NULL. Fails the test on error. */
shear_row sky_scene_measure(const sky_scene *s, const sky_way *way, shear_plan_info *info);
