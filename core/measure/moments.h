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

/* FFT_LINES columns of modes and their mirror images, as they come from a batch: left[ny s][l] is
 * column jx = FFT_LINES g + l, right[ny s][l] is column -jx. */
typedef struct mode_columns {
    const double complex *left, *right;
    int group; /* g */
} mode_columns;

/* Add what the columns of one group hold; the groups are 0 .. t->jx / FFT_LINES. */
void moments_add(moments *m, const mode_columns *columns, const transfer_plan *p,
                 const transfer *t);

/* The moments of a power that is 1 at every mode. */
moments moments_of_flat(const transfer_plan *p, const transfer *t);
/* m -= power flat */
void moments_subtract(moments *m, double power, const moments *flat);

/* The corrected power of mode (FFT_LINES g + lane, jy). For pictures. */
double moments_power(const mode_columns *columns, const transfer_plan *p, int lane, int jy);

#endif
