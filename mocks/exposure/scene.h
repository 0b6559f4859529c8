/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scene.h: the objects of a chip: places, fluxes and shapes before lensing. */
#pragma once

#include "exposure/focal_plane.h"

typedef struct scene_object {
    double x, y;   /* pixels of the chip, from 1 */
    double dx, dy; /* pixels from the field's centre */
    sky_place sky;
    double flux;   /* ADU */
    double r_half; /* arcsec; 0: a star */
    double e1, e2; /* (1 - q) / (1 + q), on the sky, before lensing */
    bool is_star;
} scene_object;

typedef struct scene {
    scene_object *objects; /* [n], owned */
    int64_t n;
} scene;

/* Make the objects of chip `i`. Returns false if out of memory. */
bool scene_init(scene *s, const shear_mock_exposure *e, const focal_plane *f, int i);
void scene_deinit(scene *s);
