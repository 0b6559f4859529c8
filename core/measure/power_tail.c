/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/power_tail.h"

#include "shear/stamp.h"

#include <math.h>
#include <stddef.h>

enum { RINGS = SHEAR_MAX_SIDE, NEGATIVE = 6 /* a ring's modes over its negative ones */ };
/* The power that is continued is that of the rings beyond this part of the first noisy one. */
static const double from_part = 0.6;
/* The seeing's exponent; that of a Gaussian would be 2. */
static const double exponent = 5.0 / 3.0;

typedef struct ring {
    double sum;
    int n, negative;
} ring;

/* Return the radius of mode i, in modes along the shorter side. */
static double radius_of(int i, int nx, int ny) {
    const int n = nx < ny ? nx : ny;
    return n * hypot((double)(i % nx - nx / 2) / nx, (double)(i / nx - ny / 2) / ny);
}

static int ring_of(double radius) {
    return radius < RINGS - 1 ? (int)lround(radius) : RINGS - 1;
}

/* Return the first noisy ring; RINGS: none. */
static int first_noisy(const ring *rings) {
    int r = 1;
    while (r < RINGS && NEGATIVE * rings[r].negative <= rings[r].n)
        r++;
    return r;
}

/* Fit ln P = a - b r^(5/3) to the mean power of the rings before `end`: their errors are in
 * proportion to 1/P and 1/sqrt(n). Return false if there are too few, or the power does not fall.
 */
static bool fit(const ring *rings, int end, double *a, double *b) {
    double s[5] = {0.0};
    for (int r = (int)ceil(from_part * end); r < end; r++) {
        const double mean = rings[r].sum / rings[r].n;
        const double w = mean > 0.0 ? mean * mean * rings[r].n : 0.0;
        const double x = pow(r, exponent);
        const double y = w > 0.0 ? log(mean) : 0.0;
        const double terms[5] = {w, w * x, w * x * x, w * y, w * x * y};
        for (int i = 0; i < 5; i++)
            s[i] += terms[i];
    }
    const double det = s[0] * s[2] - s[1] * s[1];
    *b = (s[1] * s[3] - s[0] * s[4]) / det;
    *a = (s[3] + *b * s[1]) / s[0];
    return det > 0.0 && *b > 0.0 && isfinite(*a);
}

void power_tail_fill(double *power, int nx, int ny) {
    ring rings[RINGS] = {{0.0, 0, 0}};
    double a = 0.0;
    double b = 0.0;
    for (int i = 0; i < nx * ny; i++) {
        ring *r = &rings[ring_of(radius_of(i, nx, ny))];
        r->sum += power[i];
        r->n++;
        r->negative += power[i] < 0.0 ? 1 : 0;
    }
    const int end = first_noisy(rings);
    if (end == RINGS || !fit(rings, end, &a, &b))
        return;
    for (int i = 0; i < nx * ny; i++) {
        const double radius = radius_of(i, nx, ny);
        if (ring_of(radius) >= end)
            power[i] = exp(a - b * pow(radius, exponent));
    }
}
