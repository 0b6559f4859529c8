/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/plateau.h"

#include "base/simd.h"

#include <stdint.h>
#include <stdlib.h>

/* (jx/nx)^2 + (jy/ny)^2 > (3/8)^2, in whole numbers: no rounding decides which modes count. */
static bool outside(int64_t jx, int64_t jy, int64_t nx, int64_t ny) {
    return 64 * (jx * jx * ny * ny + jy * jy * nx * nx) > 9 * nx * nx * ny * ny;
}

bool plateau_init(plateau *p, int nx, int ny) {
    *p = (plateau){.nx = nx, .ny = ny, .from = malloc((size_t)ny * sizeof *p->from)};
    for (int y = 0; p->from != NULL && y < ny; y++) {
        const int jy = y <= ny / 2 ? y : ny - y;
        int from = 0;
        while (from <= nx / 2 && !outside(from, jy, nx, ny)) {
            from++;
        }
        p->from[y] = from;
        p->n += from > nx / 2 ? 0 : nx - 2 * from + 1 - (from == 0);
    }
    return p->from != NULL;
}

void plateau_deinit(plateau *p) {
    free(p->from);
    *p = (plateau){0};
}

/* The sum over columns [from, to] of one row, where that of -k is read backwards from `there`:
 * interleaved re, im. */
SHEAR_SIMD static double sum_columns(const double *here, const double *there, int from, int to) {
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (int x = from; x <= to; x++) {
        const double *back = there - 2 * (ptrdiff_t)x;
        sum += here[2 * x] * back[0] - here[2 * x + 1] * back[1];
    }
    return sum;
}

double plateau_of(const plateau *p, const double complex *z, size_t stride) {
    double sum = 0.0;
    for (int y = 0; y < p->ny; y++) {
        const double *here = (const double *)(z + (size_t)y * stride);
        const double *there = (const double *)(z + (size_t)((p->ny - y) % p->ny) * stride);
        const int from = p->from[y];
        if (from == 0) {
            sum += here[0] * there[0] - here[1] * there[1];
        }
        const int first = from > 0 ? from : 1;
        sum += sum_columns(here, there + 2 * (ptrdiff_t)p->nx, first, p->nx - first);
    }
    return sum / p->n;
}
