/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/half_light.h"

#include <math.h>

enum { RINGS = 512, PER_SAMPLE = 8 };

double half_light(const double *image, int nx, int ny) {
    double ring[RINGS] = {0.0};
    double all = 0.0;
    double sum = 0.0;
    int peak = 0;
    for (int i = 0; i < nx * ny; i++)
        peak = image[i] > image[peak] ? i : peak;
    for (int i = 0; i < nx * ny; i++) {
        const double r = PER_SAMPLE * hypot(i % nx - peak % nx, i / nx - peak / nx);
        all += image[i];
        ring[r < RINGS - 1 ? (int)r : RINGS - 1] += image[i];
    }
    if (!(all > 0.0) || !isfinite(all))
        return NAN;
    int k = 0;
    while (k < RINGS - 1 && sum + ring[k] < 0.5 * all)
        sum += ring[k++];
    return (k + (ring[k] > 0.0 ? (0.5 * all - sum) / ring[k] : 0.0)) / PER_SAMPLE;
}
