/* SPDX-License-Identifier: GPL-3.0-or-later */
/* information.h: how well a shear could be known at best: the Cramer-Rao bound of a population.
 *
 * Without noise a galaxy's shape e_1 = (N_1 - g_2 V') / (D + U') (likewise e_2), whatever its flux,
 * is moved by a shear: e_i -> e_i + g_i. Fisher's information on g_1 is that of the location of the
 * distribution p of e_1, I = integral (dp/de)^2 / p, and no unbiased estimate from n galaxies has
 * an error below 1/sqrt(n I). Who knows a galaxy's flux knows its D at flux 1 too, and galaxies of
 * large D (compact ones) may be rounder than others: so p is counted in classes of D, and I is
 * their mean. That is the bound for anyone who sees N, D and the flux of each galaxy; who does not
 * know the flux may not reach it.
 *
 * Both components together (p(|e|) in the plane) may hold more than one alone.
 *
 * p is counted in bins of |e|; what the counts' own noise adds to the square of the slope is taken
 * off. Bins blur p, so the true bound is a little lower where p has an edge or a cusp.
 */
#ifndef VALIDATION_INFORMATION_H
#define VALIDATION_INFORMATION_H

enum { SHAPE_BINS = 60, SHAPE_CLASSES = 16 };

/* Counts of |e| in bins of 1/50 (larger ones are left out), by class of D. */
typedef struct shape_counts {
    double line[SHAPE_CLASSES][SHAPE_BINS];  /* of both components */
    double plane[SHAPE_CLASSES][SHAPE_BINS]; /* of sqrt(e_1^2 + e_2^2) */
} shape_counts;
enum { SHAPE_VALUES = 2 * SHAPE_CLASSES * SHAPE_BINS };

/* d: the galaxy's D at flux 1 over that of a typical one. */
void shape_counts_add(shape_counts *c, double d, double e1, double e2);

/* The bound on the error of one galaxy, 1/sqrt(I). */
double shape_bound_line(const shape_counts *c);
double shape_bound_plane(const shape_counts *c);

#endif
