/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/mode_plane.h: the modes of a stamp for which there are tables.
 *
 * Modes: k = (2 pi jx / nx, 2 pi jy / ny) radians per galaxy pixel, kept for |jx| <= max_jx and 0
 * <= jy <= max_jy. Half the plane is enough, since |F(k)|^2 of a real image is even. Tables are
 * [jx][jy], so that rows of modes are vector lanes. */
#pragma once

#include "fft/fft.h"

#include <math.h>

typedef struct mode_plane {
    int nx, ny;         /* stamp, pixels */
    int max_jx, max_jy; /* the largest |jx| and |jy| of modes with |k| < k_limit */
    size_t stride;      /* rows of a column, whole groups of FFT_LANES */
    size_t size;        /* of a table [2 max_jx + 1][stride] */
    double k_limit;
} mode_plane;

/* Return the largest index of a mode inside the circle: 2 pi j / n < pi side. */
static inline int mode_plane_last(int n, double side) {
    return (int)ceil(0.5 * n * side) - 1;
}

/* Return the plane of the modes |k| < pi side. */
static inline mode_plane mode_plane_of(int nx, int ny, double side) {
    mode_plane p = {.nx = nx, .ny = ny, .k_limit = M_PI * side};
    p.max_jx = mode_plane_last(nx, side);
    p.max_jy = mode_plane_last(ny, side);
    p.stride = fft_padded(p.max_jy + 1);
    p.size = (2 * (size_t)p.max_jx + 1) * p.stride;
    return p;
}

/* Return where column jx of a table begins. */
static inline size_t mode_plane_column(const mode_plane *p, int jx) {
    return (size_t)(jx + p->max_jx) * p->stride;
}
