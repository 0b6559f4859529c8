/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "exposure/drawer.h"

#include "base/arena.h"

#include <gsl/gsl_fft_complex.h>
#include <gsl/gsl_math.h>
#include <math.h>
#include <stdlib.h>

enum { MIN_SIDE = 32 };

static void place(drawer *d, arena *a) {
    const size_t n = DRAWER_MAX_SIDE;
    d->modes = arena_doubles(a, 2 * n * n);
    d->along_x = arena_doubles(a, 4 * n);
    d->along_y = arena_doubles(a, 4 * n);
}

bool drawer_init(drawer *d) {
    arena a = {0};
    *d = (drawer){0};
    place(d, &a);
    d->memory = arena_allocate(&a);
    if (d->memory == NULL)
        return false;
    place(d, &a);
    return true;
}

void drawer_deinit(drawer *d) {
    free(d->memory);
}

/* Fill an axis for an object at `at`: exp(-i k at) sinc(k / 2). */
static void fill_axis(int n, double at, double *axis) {
    for (int alias = 0; alias < 2; alias++) {
        for (int j = 0; j < n; j++) {
            const double k = 2.0 * M_PI * ((double)j / n - alias);
            const double response = light_pixel(k);
            double *z = axis + 2 * ((ptrdiff_t)alias * n + j);
            z[0] = response * cos(k * at);
            z[1] = -response * sin(k * at);
        }
    }
}

/* Add one of the four modes that are folded into (jx, jy). */
static void add_mode(const drawer *d, const light *l, int jx, int jy, int alias, double sum[2]) {
    const int n = d->n;
    const int ax = alias % 2;
    const int ay = alias / 2;
    const double *x = d->along_x + 2 * ((ptrdiff_t)ax * n + jx);
    const double *y = d->along_y + 2 * ((ptrdiff_t)ay * n + jy);
    const double kx = 2.0 * M_PI * ((double)jx / n - ax);
    const double ky = 2.0 * M_PI * ((double)jy / n - ay);
    const double t = l->flux * light_transform(l, kx, ky);
    sum[0] += t * (x[0] * y[0] - x[1] * y[1]);
    sum[1] += t * (x[0] * y[1] + x[1] * y[0]);
}

/* Return whether modes beyond the Nyquist frequency can be seen. They are in a band of about
 * 1/alpha around the square of the others: a sixth of this bound. */
static bool is_aliased(const light *l, double threshold) {
    const double t = fmax(light_transform(l, M_PI, 0.0), light_transform(l, 0.0, M_PI));
    return l->flux * t > threshold;
}

/* The image is real: half of the modes are the others' conjugates. */
static void fill_modes(drawer *d, const light *l, double threshold) {
    const int n = d->n;
    const bool aliased = is_aliased(l, threshold);
    for (int jy = 0; jy <= n / 2; jy++) {
        for (int jx = 0; jx < n; jx++) {
            double sum[2] = {0.0, 0.0};
            const int nearest = (2 * jx >= n) + 2 * (2 * jy >= n);
            for (int alias = 0; alias < 4; alias++) {
                if (aliased || alias == nearest)
                    add_mode(d, l, jx, jy, alias, sum);
            }
            double *z = d->modes + 2 * ((ptrdiff_t)jy * n + jx);
            double *conjugate = d->modes + 2 * ((ptrdiff_t)((n - jy) % n) * n + (n - jx) % n);
            conjugate[0] = sum[0];
            conjugate[1] = -sum[1];
            z[0] = sum[0];
            z[1] = sum[1];
        }
    }
}

static void transform_back(drawer *d) {
    const size_t n = (size_t)d->n;
    for (size_t i = 0; i < n; i++)
        gsl_fft_complex_radix2_inverse(d->modes + 2 * i * n, 1, n);
    for (size_t i = 0; i < n; i++)
        gsl_fft_complex_radix2_inverse(d->modes + 2 * i, n, n);
}

void drawer_place(drawer *d, const light *l, double x, double y, double threshold) {
    const double reach = light_reach(l, threshold);
    d->n = MIN_SIDE;
    while (d->n < 2.0 * reach && d->n < DRAWER_MAX_SIDE)
        d->n *= 2;
    d->x = (int)floor(x + 0.5) - d->n / 2;
    d->y = (int)floor(y + 0.5) - d->n / 2;
}

void drawer_draw(drawer *d, const light *l, double x, double y, double threshold) {
    fill_axis(d->n, x - d->x, d->along_x);
    fill_axis(d->n, y - d->y, d->along_y);
    fill_modes(d, l, threshold);
    transform_back(d);
}

bool drawer_touches(const drawer *d, const image_band *band) {
    return d->y < band->end && d->y + d->n > band->first;
}

void drawer_add(const drawer *d, const image_band *band) {
    const int x0 = d->x > 0 ? d->x : 0;
    const int y0 = d->y > band->first ? d->y : band->first;
    const int x1 = d->x + d->n < band->nx ? d->x + d->n : band->nx;
    const int y1 = d->y + d->n < band->end ? d->y + d->n : band->end;
    for (int y = y0; y < y1; y++) {
        const double *stamp = d->modes + 2 * (ptrdiff_t)(y - d->y) * d->n;
        for (int x = x0; x < x1; x++)
            band->image[(ptrdiff_t)y * band->nx + x] += stamp[2 * (x - d->x)];
    }
}
