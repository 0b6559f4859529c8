/* SPDX-License-Identifier: GPL-3.0-or-later */
/* population.h: galaxies as a ground-based survey sees them, number by number; and dice.
 *
 * Half-light radii are log-uniform from 2 to 4.5 px, up to half of the light is in a bulge of 0.6
 * times the disk's radius, and a component of the ellipticity (|e| = (a - b)/(a + b)) has a scatter
 * of 0.26, cut at |e| = 0.7. All is a function of seed and number only.
 */
#ifndef VALIDATION_POPULATION_H
#define VALIDATION_POPULATION_H

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
/* n unit Gaussians. */
void dice_normal(dice *d, int n, double *out);

/* ---- galaxies ---- */

typedef struct population {
    uint64_t seed;
    bool bulges;     /* all light in bulges as large as the disks */
    int copies;      /* stamps of one galaxy, each rotated 180 / copies degrees farther; 1: one
                        stamp, rotated at random */
    double shear[2]; /* (1 + g1, g2; g2, 1 - g1) maps what is rotated */
} population;

/* The galaxy of `stamp`, rotated and sheared, and the place of its centre within a pixel: the same
 * at any shear. */
light_galaxy population_galaxy(const population *p, int64_t stamp);
void population_centre(const population *p, int64_t stamp, double *x, double *y);
/* The same galaxy as if there were no shear, not rotated. */
light_galaxy population_bare(const population *p, int64_t stamp);
/* Half-light radius of its disk, px. */
double population_radius(const population *p, int64_t stamp);

#endif
