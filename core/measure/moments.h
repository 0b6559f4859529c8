/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/moments.h: the moments of a noise-corrected power spectrum from the transform of a packed
 * pair.
 *
 * The galaxy g and the noise n are real, z = g + i n is transformed once, and
 *     Re[Z(k) Z(-k)] = |G(k)|^2 - |N(k)|^2
 * is the corrected power at once (Zhang (2010), eq. (8), mode by mode; all moments are even in k).
 * Its imaginary part is the cross spectrum 2 Re[G(k) N*(k)].
 */
#ifndef SHEAR_MEASURE_MOMENTS_H
#define SHEAR_MEASURE_MOMENTS_H

#include "measure/transfer.h"

typedef struct moments {
    double m20, m02, m11, m4, u, v;
} moments;

/* FFT_LANES rows of modes and their mirror images, as they come from a transform along x: lane l of
 * up is row jy = FFT_LANES group + l, of down row -jy; both [nx + 1][FFT_LANES], where element jx <
 * 0 is at nx + jx, and 0 at nx, too. */
typedef struct mode_rows {
    fft_lanes up, down;
    int nx; /* fine */
    int group;
} mode_rows;

/* Add what the rows of one group hold; the groups are 0 .. t->jy / FFT_LANES. `noise`: of the noise
 * stamp alone; NULL where it is not wanted. */
void moments_add(moments *m, moments *noise, const mode_rows *rows, const transfer_plan *p,
                 const transfer *t);
/* The same of the cross spectrum. */
void moments_add_cross(moments *m, const mode_rows *rows, const transfer_plan *p,
                       const transfer *t);

/* The moments of a power that is 1 at every mode. */
moments moments_of_flat(const transfer_plan *p, const transfer *t);
/* m += factor other */
void moments_join(moments *m, double factor, const moments *other);

/* The corrected power of mode (jx, FFT_LANES group + lane). For pictures. */
double moments_power(const mode_rows *rows, int jx, int lane);

#endif
