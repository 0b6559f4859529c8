/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/moments.h: the moments of a noise-corrected power spectrum from the transform of a packed
 * pair.
 *
 * The galaxy g and the noise n are real, z = g + i n is transformed once, and
 *     Re[Z(k) Z(-k)] = |G(k)|^2 - |N(k)|^2
 * is the corrected power at once (label OSN3 mode by mode; all moments are even in k).
 */
#ifndef SHEAR_MOMENTS_H
#define SHEAR_MOMENTS_H

#include "measure/transfer.h"

#include <complex.h>

typedef struct moments {
    double m20, m02, m11, m4, u, v;
} moments;

/* Z: [ny s][stride] with columns -t->jx .. t->jx (mod nx s) transformed; `flat` is taken off the
 * corrected power of every mode. */
moments moments_of(const double complex *z, size_t stride, const transfer_plan *p,
                   const transfer *t, double flat);

/* The corrected power of one mode, |jx| and |jy| within the transformed columns. For pictures. */
double moments_power(const double complex *z, size_t stride, const transfer_plan *p, int jx,
                     int jy);

#endif
