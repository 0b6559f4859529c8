/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/centring.h
 * Whether the light of galaxies is where their positions are: the check of positions that count
 * from 0 or from 1, are of another image, or of other objects.
 *
 * A shift of the galaxy in its stamp changes no shear. But positions that are wrong by a pixel
 * choose wrong masks, and those that are wrong by more choose no galaxies.
 */
#ifndef SHEAR_CENTRING_H
#define SHEAR_CENTRING_H

#include "shear/linkage.h"
#include "shear/stamp.h"

#include <stdbool.h>
#include <stdint.h>

SHEAR_BEGIN_C

/** Distances of light from positions, of a sample of galaxies. */
typedef struct shear_centring {
    int64_t looked_at; /**< galaxies; 0: nothing is known */
    int64_t found;     /**< of those, galaxies with light near the position; of these: */
    double x;          /**< median distance of the light from the position, columns, pixels */
    double y;          /**< the same, rows */
    double x_err;      /**< error of the median, from the scatter; NaN of fewer than 2 */
    double y_err;      /**< the same, rows */
} shear_centring;

/** Find the light of stamp `i`, within 8 px of the middle of its galaxy stamp: the centre of the
 * brightest spot, if it is brighter than that of its noise stamp by half.
 *
 * @param stamps  the stamps; all planes of noise but the first are left alone
 * @param i       which of them
 * @param x       position in the image whose nearest pixel is the stamp's [ny/2][nx/2], columns
 * @param y       the same, rows
 * @param dx      distance of the light from the position, columns; 0 if there is none
 * @param dy      the same, rows
 * @return whether there is light
 */
bool shear_centring_find(const shear_stamps *stamps, int i, double x, double y, double *dx,
                         double *dy);
/** Summarize `found` distances of `looked_at` galaxies. The arrays are used up. */
void shear_centring_summarize(shear_centring *c, int64_t looked_at, double *dx, double *dy,
                              int64_t found);

/** Return whether positions are wrong: the light of at least 20 galaxies is more than half a pixel
 * away (and 5 errors), in columns or rows. */
bool shear_centring_is_off(const shear_centring *c);
/** Return whether positions are not those of galaxies: of at least 20, fewer than a seventh have
 * light; or the light lies anywhere: half of 8 or more is farther than 2 px from its median, in
 * columns and in rows. */
bool shear_centring_is_lost(const shear_centring *c);

SHEAR_END_C

#endif
