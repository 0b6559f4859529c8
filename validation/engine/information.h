/* SPDX-License-Identifier: GPL-3.0-or-later */
/* information.h: the Cramer-Rao bound of a population: the smallest possible error of the shear.
 *
 * Without noise a galaxy's shape e_1 = (N_1 - g_2 V') / (D + U') (likewise e_2), which does not
 * depend on its flux, is shifted by a shear: e_i -> e_i + g_i. Fisher's information on g_1 is that
 * of the location of the distribution p of e_1, I = integral (dp/de)^2 / p. No unbiased estimate
 * from n galaxies has an error below 1/sqrt(n I). If a galaxy's flux is known, so is its D at flux
 * 1, and galaxies of large D (compact ones) may be rounder. So p is counted in classes of D, and I
 * is their mean. That is the bound for estimators that use N, D and the flux of each galaxy; those
 * that do not know the flux may not reach it.
 *
 * Both components together (p(|e|) in the plane) may contain more information than one.
 *
 * p is counted in bins of |e|, and the contribution of the counts' noise to the square of the slope
 * is subtracted. Binning smooths p, so the true bound is slightly lower if p has an edge or a cusp.
 */
#pragma once

enum { SHAPE_BINS = 60, SHAPE_CLASSES = 16 };

/* Counts of |e| in bins of 1/50, by class of D. Larger |e| are not counted. */
typedef struct shape_counts {
    double line[SHAPE_CLASSES][SHAPE_BINS];  /* both components */
    double plane[SHAPE_CLASSES][SHAPE_BINS]; /* sqrt(e_1^2 + e_2^2) */
} shape_counts;
enum { SHAPE_VALUES = 2 * SHAPE_CLASSES * SHAPE_BINS };

/* Add a galaxy. d is its D at flux 1, divided by that of a typical galaxy. */
void shape_counts_add(shape_counts *c, double d, double e1, double e2);

/* Return the bound on the error of one galaxy, 1/sqrt(I). */
double shape_bound_line(const shape_counts *c);
double shape_bound_plane(const shape_counts *c);
