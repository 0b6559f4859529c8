/* SPDX-License-Identifier: GPL-3.0-or-later */
/* population.h: galaxies similar to those of a ground-based survey, and random numbers.
 *
 * Half-light radii are log-uniform from 2 to 4.5 px. Up to half of the light is in a bulge of 0.6
 * times the disk's radius. Each component of the ellipticity (|e| = (a - b)/(a + b)) has a scatter
 * of 0.26, cut at |e| = 0.7. Everything is a function of seed and number only. */
#pragma once

#include "engine/light.h"

#include <stdbool.h>
#include <stdint.h>

/* ---- random numbers: a sequence for each (seed, purpose, index); splitmix64 ---- */

enum dice_purpose {
    DICE_GALAXY = 1,
    DICE_ROTATION,
    DICE_SHIFT,
    DICE_NOISE,
    DICE_NOISE_STAMP,
    DICE_PHOTONS,
    DICE_ARTEFACT
};

typedef struct dice {
    uint64_t state;
} dice;
dice dice_begin(uint64_t seed, enum dice_purpose purpose, int64_t index);
double dice_uniform(dice *d); /* in [0, 1) */
/* Return the number in [0, 1) that the bits of z, well mixed, give. */
double dice_mixed(uint64_t z);
/* Draw n Gaussian numbers of unit variance. */
void dice_normal(dice *d, int n, double *out);

/* ---- galaxies ---- */

typedef struct population {
    uint64_t seed;
    bool bulges;     /* all light is in bulges of the size of the disks */
    int copies;      /* stamps per galaxy, each rotated by 180 / copies degrees more; 1: one stamp,
                        rotated at random */
    double shear[2]; /* (1 + g1, g2; g2, 1 - g1), applied after the rotation */
} population;

/* Return the galaxy of `stamp`, rotated and sheared, and the position of its centre within a pixel,
 * which does not depend on the shear. */
light_galaxy population_galaxy(const population *p, int64_t stamp);
void population_centre(const population *p, int64_t stamp, double *x, double *y);
/* Return the same galaxy without shear and rotation. */
light_galaxy population_bare(const population *p, int64_t stamp);
/* Return the half-light radius of its disk, px. */
double population_radius(const population *p, int64_t stamp);
