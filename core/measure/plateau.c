/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/plateau.h"

#include "base/simd.h"
#include "fft/fft.h"

#include <stdint.h>
#include <string.h>

/* (jx/nx)^2 + (jy/ny)^2 > (3/8)^2, in whole numbers: no rounding decides which modes count. */
static bool outside(int64_t jx, int64_t jy, int64_t nx, int64_t ny) {
    return 64 * (jx * jx * ny * ny + jy * jy * nx * nx) > 9 * nx * nx * ny * ny;
}

/* How many modes of the whole plane column jx stands for, in each row. */
static double images(int jx, int nx) {
    return jx == 0 || 2 * jx == nx ? 1.0 : 2.0;
}

bool plateau_init(plateau *p, int nx, int ny) {
    *p = (plateau){
        .nx = nx, .ny = ny, .last_group = nx / 2 / FFT_LINES, .stride = fft_padded(nx / 2 + 1)};
    const size_t size = (size_t)ny * p->stride;
    p->share = fft_alloc(size * sizeof *p->share);
    if (p->share == NULL) {
        return false;
    }
    memset(p->share, 0, size * sizeof *p->share);
    for (int y = 0; y < ny; y++) {
        for (int jx = 0; jx <= nx / 2; jx++) {
            const double counts =
                outside(jx, y <= ny / 2 ? y : ny - y, nx, ny) ? images(jx, nx) : 0.0;
            p->share[(size_t)y * p->stride + (size_t)jx] = counts;
            p->n += counts;
        }
    }
    for (size_t i = 0; i < size; i++) {
        p->share[i] /= p->n;
    }
    return true;
}

void plateau_deinit(plateau *p) {
    fft_free(p->share);
    *p = (plateau){0};
}

SHEAR_SIMD static double sum_row(const double *here, const double *there, const double *share) {
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (int l = 0; l < FFT_LINES; l++) {
        sum += share[l] * (here[2 * l] * there[2 * l] - here[2 * l + 1] * there[2 * l + 1]);
    }
    return sum;
}

double plateau_part(const plateau *p, const mode_columns *c) {
    double sum = 0.0;
    for (int y = 0; y < p->ny; y++) {
        const size_t back = (size_t)((p->ny - y) % p->ny) * FFT_LINES;
        sum += sum_row((const double *)(c->left + (size_t)y * FFT_LINES),
                       (const double *)(c->right + back),
                       p->share + (size_t)y * p->stride + (size_t)c->group * FFT_LINES);
    }
    return sum;
}
