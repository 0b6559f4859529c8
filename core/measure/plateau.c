/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/plateau.h"

#include "base/simd.h"
#include "fft/fft.h"

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>

/* (jx/nx)^2 + (jy/ny)^2 > (3/8)^2, in integers, so that rounding does not decide which modes
 * count. */
static bool outside(int64_t jx, int64_t jy, int64_t nx, int64_t ny) {
    return 64 * (jx * jx * ny * ny + jy * jy * nx * nx) > 9 * nx * nx * ny * ny;
}

/* Return how many modes of the whole plane row jy stands for, in each column. */
static double images(int jy, int ny) {
    return jy == 0 || 2 * jy == ny ? 1.0 : 2.0;
}

void plateau_place(plateau *p, int nx, int ny, arena *a) {
    *p = (plateau){
        .nx = nx, .ny = ny, .last_group = ny / 2 / FFT_LANES, .stride = fft_padded(ny / 2 + 1)};
    const size_t size = (size_t)nx * p->stride;
    p->share = arena_doubles(a, size);
    if (a->memory == NULL)
        return;
    for (int x = 0; x < nx; x++) {
        for (int jy = 0; jy <= ny / 2; jy++) {
            const double counts =
                outside(x <= nx / 2 ? x : nx - x, jy, nx, ny) ? images(jy, ny) : 0.0;
            p->share[(size_t)x * p->stride + (size_t)jy] = counts;
            p->n += counts;
        }
    }
    for (size_t i = 0; i < size; i++)
        p->share[i] /= p->n;
}

SHEAR_SIMD static void sum_rows(const mode_rows *rows, const double *share, size_t stride,
                                double *sums, double *noise_sums) {
    const mode_rows r = *rows;
    for (size_t x = 0; x < (size_t)r.nx; x++) {
        const size_t at = x * FFT_LANES;
        const size_t mirrored = ((size_t)r.nx - x) * FFT_LANES;
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++) {
            const mode z = mode_at(&r, at + l, mirrored + l);
            sums[l] += share[x * stride + l] * mode_difference(z);
            noise_sums[l] += share[x * stride + l] * mode_noise(z);
        }
    }
}

static double sum_of(const double *lanes) {
    double sum = 0.0;
    for (int l = 0; l < FFT_LANES; l++)
        sum += lanes[l];
    return sum;
}

void plateau_add(const plateau *p, const mode_rows *r, double *mean, double *noise_mean) {
    assert(r->group >= 0 && r->group <= p->last_group && r->nx == p->nx);
    double sums[FFT_LANES] = {0};
    double noise_sums[FFT_LANES] = {0};
    sum_rows(r, p->share + (size_t)r->group * FFT_LANES, p->stride, sums, noise_sums);
    *mean += sum_of(sums);
    *noise_mean += sum_of(noise_sums);
}
