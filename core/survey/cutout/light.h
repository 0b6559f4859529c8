/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/light.h: which pixels of a galaxy's box hold its light, which are another's, and
 * what is wrong with it.
 *
 * The light is all pixels of its isophote, and all within R of its position. */
#pragma once

#include "survey/cutout/growth.h"

#include <stdbool.h>
#include <stdint.h>

enum { LIGHT_GROW = 3 }; /* pixels by which other objects are grown */

/* Radius that holds a galaxy's light, beyond its own r_gal, in units of R_PSF: half of a mock
 * galaxy's light is within 0.5 to 0.7 R_G, and all of it within R_G + 2.6 R_PSF. */
#define LIGHT_PSF_RADII 2.6

/* A galaxy's box of side x side pixels. */
typedef struct light {
    int side, frame; /* the stamp is without `frame` pixels on each side */
    double r_psf_px;
    const uint8_t *defect; /* [side][side] */
    const int32_t *owner;  /* [side + 2 LIGHT_GROW] squared: LIGHT_GROW pixels more on each side */
    uint8_t *mask;         /* [side][side] 1: a defect, or another's (grown) */
    uint8_t *away;         /* [side][side] 1: not to be used for the plane: masked, or its own */
    uint8_t *own;          /* [side][side] 1: its light */
    uint8_t *marks;        /* scratch: of others */
    growth grown;
} light;

void light_place(light *l, int side, int frame, arena *a);
/* Fill mask, away and own for a galaxy at (x, y), in pixels from the box's first, with r_gal as in
 * cutter_source. owner: its number; 0: that of the pixel at its position. Return its flags. */
uint32_t light_find(light *l, double x, double y, double r_gal, int32_t owner);
