/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/plateau.h: the flat power of shot noise, read off where a galaxy has none (Zhang, Luo &
 * Foucaud 2015): the mean over the modes with |k| > 3/4 of Nyquist, the stamp's corners included.
 * Only without interpolation: that would colour white noise.
 */
#ifndef SHEAR_PLATEAU_H
#define SHEAR_PLATEAU_H

#include <complex.h>
#include <stdbool.h>
#include <stddef.h>

/* The modes outside the circle, row by row. */
typedef struct plateau {
    int nx, ny;
    int *from; /* [ny] modes |jx| >= from[y] of row y lie outside */
    double n;  /* so many modes */
} plateau;

/* false when memory is out. */
bool plateau_init(plateau *p, int nx, int ny);
void plateau_deinit(plateau *p);

/* The mean of Re[Z(k) Z(-k)] = |G(k)|^2 - |N(k)|^2: the galaxy's plateau less the noise stamp's.
 * Z: [ny][stride], all columns transformed. */
double plateau_of(const plateau *p, const double complex *z, size_t stride);

#endif
