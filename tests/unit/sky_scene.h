/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/sky_scene.h: Gaussian galaxies and PSFs on the sky, drawn on pixels of any Jacobian.
 */
#pragma once

#include "gaussian.h"

#include "shear/plan.h"

enum { SCENE_SIDE = 64, SCENE_PSF_SIDE = 81 };

/* Sizes in arcsec; flux is 1 times the galaxy's amplitude. */
typedef struct sky_scene {
    gaussian galaxy, psf;    /* (u, v) to the West and the North */
    double jacobian[4];      /* du/dx, du/dy, dv/dx, dv/dy, arcsec per pixel */
    double shift_x, shift_y; /* of the galaxy from the middle of its stamp, pixels */
    double step;             /* of the PSF's samples, pixels */
    double pixels[SCENE_SIDE * SCENE_SIDE], noise[SCENE_SIDE * SCENE_SIDE];
    double samples[SCENE_PSF_SIDE * SCENE_PSF_SIDE];
} sky_scene;

/* A scene of an elongated galaxy and PSF on pixels of `scale` arcsec, turned by `angle` radians,
 * mirrored (East to the right) if so, and sheared by (g1, g2) in the pixels' axes. */
void sky_scene_init(sky_scene *s, double scale, double angle, bool mirrored, double g1, double g2);
/* Draw the stamps and the PSF's samples. */
void sky_scene_draw(sky_scene *s);

/* What a measurement of the scene is made of. */
typedef struct sky_way {
    enum shear_frame frame;
    bool model; /* the PSF is a model of one term; else one image of whole oversampling */
    const char *estimator; /* NULL: mean */
    double beta_px;
} sky_way;
/* Plan and measure; the plan's decisions go to *info unless it is NULL. Fails the test on error. */
shear_row sky_scene_measure(const sky_scene *s, const sky_way *way, shear_plan_info *info);
