/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/moments.h: the moments of a noise-corrected power spectrum from the transform of a packed
 * pair.
 *
 * The galaxy g and the noise n are real, z = g + i n is transformed once, and
 *     Re[Z(k) Z(-k)] = |G(k)|^2 - |N(k)|^2
 * is the corrected power at once (Zhang (2010), eq. (8), mode by mode; all moments are even in k).
 * Its imaginary part is the cross spectrum 2 Re[G(k) N*(k)].
 */
#pragma once

#include "base/simd.h"
#include "measure/transfer.h"

/* Sums over k of T P times kx^2, ky^2, kx ky, k^4, kx^4 - 6 kx^2 ky^2 + ky^4, kx^3 ky - kx ky^3,
 * kx^4 - ky^4, and kx^3 ky + kx ky^3. The last two are only needed to change the frame. */
typedef struct moments {
    double m20, m02, m11, m4, u, v, c4, s4;
} moments;

/* FFT_LANES rows of modes and their mirror images, as a transform along x leaves them. Lane l of
 * `up` is row jy = FFT_LANES group + l, lane l of `down` is row -jy. Both are [nx + 1][FFT_LANES]:
 * element jx < 0 is at nx + jx, and element 0 is at nx, too. */
typedef struct mode_rows {
    fft_lanes up, down;
    int nx; /* columns of the fine grid */
    int group;
} mode_rows;

/* A mode and its mirror image. */
typedef struct mode {
    double a, b, c, d; /* Z(k) = a + ib, Z(-k) = c + id */
} mode;

/* Return element `here` of up and element `there` of down. */
static SHEAR_INLINE mode mode_at(const mode_rows *r, size_t here, size_t there) {
    return (mode){
        .a = r->up.re[here], .b = r->up.im[here], .c = r->down.re[there], .d = r->down.im[there]};
}

/* Return |G|^2 - |N|^2. */
static SHEAR_INLINE double mode_difference(mode z) {
    return z.a * z.c - z.b * z.d;
}

/* Return |N|^2, from N itself: a difference of the two sums would lose it beside a bright
 * galaxy. */
static SHEAR_INLINE double mode_noise(mode z) {
    const double re = 0.5 * (z.b + z.d);
    const double im = 0.5 * (z.a - z.c);
    return re * re + im * im;
}

/* Add the modes of one group; groups are 0 .. t->jy / FFT_LANES. `noise` gets the moments of the
 * noise stamp alone, or is NULL. */
void moments_add(moments *m, moments *noise, const mode_rows *rows, const mode_plane *p,
                 const transfer *t);
/* The same for the cross spectrum. */
void moments_add_cross(moments *m, const mode_rows *rows, const mode_plane *p, const transfer *t);

/* Return the moments of a power that is 1 at every mode. */
moments moments_of_flat(const mode_plane *p, const transfer *t);
/* m += factor other */
void moments_join(moments *m, double factor, const moments *other);

/* Turn sums over k into those over q in another frame, as integrals over that frame's plane. */
void moments_take_to_frame(moments *m, const frame_map *map);

/* Return the corrected power of mode (jx, FFT_LANES group + lane). For images only. */
double moments_power(const mode_rows *rows, int jx, int lane);
