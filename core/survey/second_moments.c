/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/second_moments.h"

#include <math.h>
#include <stddef.h>

enum { MAX_STEPS = 100 };

static const double converged = 1e-6;

/* A Gaussian weight; c is its covariance: xx, xy, yy. */
typedef struct weight {
    double x, y;
    double c[3];
} weight;

/* Begin at the peak, with the round Gaussian whose core above half the peak is as large as the
 * image's. */
static bool begin(weight *w, const double *image, int nx, int ny) {
    const size_t n = (size_t)nx * (size_t)ny;
    size_t peak = 0;
    double core = 0.0;
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(image[i]))
            return false;
        peak = image[i] > image[peak] ? i : peak;
    }
    for (size_t i = 0; i < n; i++)
        core += image[i] > 0.5 * image[peak];
    const double variance = fmax(core / (2.0 * acos(-1.0) * log(2.0)), 0.25);
    *w = (weight){.x = (double)(peak % (size_t)nx),
                  .y = (double)(peak / (size_t)nx),
                  .c = {variance, 0.0, variance}};
    return image[peak] > 0.0;
}

/* Weighted sums: of values, and of their first and second moments about the weight's centre. */
typedef struct sums {
    double v, x, y, xx, xy, yy;
} sums;

static sums add_up(const weight *w, const double *image, int nx, int ny, double det) {
    sums s = {0};
    for (int j = 0; j < ny; j++) {
        const double y = j - w->y;
        for (int i = 0; i < nx; i++) {
            const double x = i - w->x;
            const double r2 = (w->c[2] * x * x - 2.0 * w->c[1] * x * y + w->c[0] * y * y) / det;
            const double v = exp(-0.5 * r2) * image[(size_t)j * (size_t)nx + (size_t)i];
            s.v += v;
            s.x += v * x;
            s.y += v * y;
            s.xx += v * x * x;
            s.xy += v * x * y;
            s.yy += v * y * y;
        }
    }
    return s;
}

/* Move the weight to the image's moments under it. The product of two equal Gaussians has half
 * their covariance, and half their distance. Returns the change, relative; negative: it failed. */
static double step(weight *w, const double *image, int nx, int ny) {
    const double det = w->c[0] * w->c[2] - w->c[1] * w->c[1];
    const sums s = add_up(w, image, nx, ny, det);
    const double x = s.x / s.v;
    const double y = s.y / s.v;
    const double c[3] = {2.0 * (s.xx / s.v - x * x), 2.0 * (s.xy / s.v - x * y),
                         2.0 * (s.yy / s.v - y * y)};
    const double trace = c[0] + c[2];
    const double limit = ((double)nx * nx + (double)ny * ny) / 12.0; /* that of a flat image */
    if (!(s.v > 0.0) || !(c[0] * c[2] - c[1] * c[1] > 1e-6 * trace * trace) || !(c[0] > 0.0) ||
        !(trace < limit)) {
        return -1.0;
    }
    double change = (fabs(x) + fabs(y)) / sqrt(trace);
    for (int k = 0; k < 3; k++) {
        change += fabs(c[k] - w->c[k]) / trace;
        w->c[k] = c[k];
    }
    w->x += 2.0 * x;
    w->y += 2.0 * y;
    return change;
}

bool second_moments(const double *image, int nx, int ny, double cov[3]) {
    weight w = {0};
    double change = begin(&w, image, nx, ny) ? INFINITY : -1.0;
    for (int i = 0; i < MAX_STEPS && change > converged; i++)
        change = step(&w, image, nx, ny);
    const bool good = change >= 0.0 && change <= converged;
    for (int k = 0; k < 3; k++)
        cov[k] = good ? w.c[k] : NAN;
    return good;
}

void second_moments_of_power(double k[3]) {
    const double det = 2.0 * (k[0] * k[2] - k[1] * k[1]);
    const double c[3] = {k[2] / det, -k[1] / det, k[0] / det};
    for (int i = 0; i < 3; i++)
        k[i] = c[i];
}

void second_moments_to_pixels(double c[3], const double j[4]) {
    const double det = j[0] * j[3] - j[1] * j[2];
    const double a[4] = {j[3] / det, -j[1] / det, -j[2] / det, j[0] / det};
    const double u[2] = {a[0] * c[0] + a[1] * c[1], a[0] * c[1] + a[1] * c[2]};
    const double v[2] = {a[2] * c[0] + a[3] * c[1], a[2] * c[1] + a[3] * c[2]};
    c[0] = u[0] * a[0] + u[1] * a[1];
    c[1] = u[0] * a[2] + u[1] * a[3];
    c[2] = v[0] * a[2] + v[1] * a[3];
}
