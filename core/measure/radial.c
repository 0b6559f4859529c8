/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The response of a round galaxy's shear through a filter, to first order.
 *
 * A round source f(k) under the shear g1 becomes f + g1 k f'(k) cos(2 phi), behind the PSF W; so
 * the image is A + g1 B cos(2 phi), A = f W, B = k f' W. The filter multiplies image and change in
 * real space; then
 *
 *     dN1/dg1 = -1/2 sum (kx^2 - ky^2) 2 T A' B' cos(2 phi)
 *     D       = sum (k^2 - beta^2/2 k^4) T A'^2
 *
 * with the filtered A' and B'. Factors that do not depend on the filter cancel. */
#include "measure/radial.h"

#include "base/arena.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Modes beyond this many scales of the target over the PSF have negligible weight. */
static const double last_scale = 5.0;

static void place(radial *q, arena *a) {
    const size_t n_r = (size_t)q->n_r;
    const size_t n_k = (size_t)q->n_k;
    q->r = arena_doubles(a, n_r);
    q->profile = arena_doubles(a, n_r);
    q->lensed = arena_doubles(a, n_r);
    q->filtered = arena_doubles(a, n_r);
    q->changed = arena_doubles(a, n_r);
    q->k = arena_doubles(a, n_k);
    q->target = arena_doubles(a, n_k);
    q->j0 = arena_doubles(a, n_k * n_r);
    q->j1 = arena_doubles(a, n_k * n_r);
    q->j2 = arena_doubles(a, n_k * n_r);
}

static void fill(radial *q, double step_k, double scale2) {
    for (int i = 0; i < q->n_r; i++)
        q->r[i] = (i + 0.5) * RADIAL_STEP;
    for (int j = 0; j < q->n_k; j++) {
        const double k = (j + 0.5) * step_k;
        q->k[j] = k;
        q->target[j] = k * k * k * exp(-scale2 * k * k);
        for (int i = 0; i < q->n_r; i++) {
            const size_t at = (size_t)j * (size_t)q->n_r + (size_t)i;
            const double x = k * q->r[i]; // NOLINT(clang-analyzer-core.*): set above
            q->j0[at] = j0(x);
            q->j1[at] = j1(x);
            q->j2[at] = 2.0 * q->j1[at] / x - q->j0[at];
        }
    }
}

bool radial_init(radial *q, double r_max, double r_psf, double beta) {
    assert(r_max > 0.0 && r_psf > 0.0 && beta > 0.0);
    /* a target narrower than the PSF has no limit of its own: any finite one will do */
    const double scale2 = fmax(beta * beta - r_psf * r_psf, 0.1 * beta * beta);
    const double k_max = fmin(M_PI, last_scale / sqrt(scale2));
    const int by_range = (int)ceil(1.5 * k_max * r_max / M_PI);
    *q = (radial){.n_r = (int)ceil(r_max / RADIAL_STEP),
                  .n_k = by_range > 64 ? by_range : 64,
                  .r_psf = r_psf,
                  .beta = beta};
    arena a = {0};
    place(q, &a);
    q->memory = arena_allocate(&a);
    if (q->memory == NULL)
        return false;
    place(q, &a);
    fill(q, k_max / q->n_k, scale2);
    return true;
}

void radial_deinit(radial *q) {
    free(q->memory);
    *q = (radial){0};
}

/* Return the sum over r of value r J(k r), for mode j. */
static double transform(const radial *q, const double *bessel, int j, const double *value) {
    const double *row = bessel + (size_t)j * (size_t)q->n_r;
    double sum = 0.0;
    for (int i = 0; i < q->n_r; i++)
        sum += value[i] * q->r[i] * row[i];
    return sum;
}

/* Return B(k) from A = 2 pi int r J0 I and k A' = -2 pi int k r^2 J1 I: behind the Gaussian W, B =
 * W k (A/W)' = k A' + r_psf^2 k^2 A. The factor 2 pi RADIAL_STEP is left out. */
static double change_at(radial *q, int j) {
    const double k = q->k[j];
    for (int i = 0; i < q->n_r; i++)
        q->filtered[i] = q->profile[i] * q->r[i];
    const double a = transform(q, q->j0, j, q->profile);
    return -k * transform(q, q->j1, j, q->filtered) + q->r_psf * q->r_psf * k * k * a;
}

static double ratio(const radial *q, const double *image, const double *change) {
    double n = 0.0;
    double d = 0.0;
    for (int j = 0; j < q->n_k; j++) {
        const double k = q->k[j];
        const double a = transform(q, q->j0, j, image);
        n += q->target[j] * a * transform(q, q->j2, j, change);
        d += q->target[j] * (1.0 - 0.5 * q->beta * q->beta * k * k) * a * a;
    }
    return n / d;
}

void radial_load(radial *q) {
    const double step_k = q->n_k > 1 ? q->k[1] - q->k[0] : q->k[0];
    memset(q->lensed, 0, (size_t)q->n_r * sizeof *q->lensed);
    for (int j = 0; j < q->n_k; j++) {
        const double b = change_at(q, j) * q->k[j] * step_k;
        for (int i = 0; i < q->n_r; i++)
            q->lensed[i] += b * q->j2[(size_t)j * (size_t)q->n_r + (size_t)i];
    }
    q->unfiltered = ratio(q, q->profile, q->lensed);
}

double radial_response(radial *q, double core_px, double width_px) {
    double *image = q->filtered;
    double *change = q->changed;
    for (int i = 0; i < q->n_r; i++) {
        const double x = fmax(0.0, (q->r[i] - core_px) / width_px);
        image[i] = exp(-0.5 * x * x) * q->profile[i];
        change[i] = exp(-0.5 * x * x) * q->lensed[i];
    }
    return ratio(q, image, change) / q->unfiltered;
}
