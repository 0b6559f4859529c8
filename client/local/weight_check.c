/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/weight_check.h"

#include "base/array.h"
#include "base/cleanup.h"

#include <math.h>
#include <stdlib.h>

void weight_check_deinit(weight_check *c) {
    free(c->weight);
    free(c->flux);
    *c = (weight_check){0};
}

static bool reserve(weight_check *c) {
    size_t capacity = c->capacity;
    return ARRAY_RESERVE(c->weight, capacity, c->n + 1) &&
           ARRAY_RESERVE(c->flux, c->capacity, c->n + 1);
}

static double mean_of(const double *pixel, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += pixel[i];
    return sum / (double)n;
}

static double central_flux(const double *galaxy, int nx, int ny, double level) {
    const double x0 = 0.5 * (nx - 1);
    const double y0 = 0.5 * (ny - 1);
    const double radius = 0.25 * (nx < ny ? nx : ny);
    double sum = 0.0;
    for (int y = 0; y < ny; y++) {
        for (int x = 0; x < nx; x++) {
            const bool inside = hypot(x - x0, y - y0) <= radius;
            sum += inside ? galaxy[(size_t)y * (size_t)nx + (size_t)x] - level : 0.0;
        }
    }
    return sum;
}

void weight_check_add(weight_check *c, const shear_stamps *t, int i) {
    const size_t n = (size_t)t->nx * (size_t)t->ny;
    if (t->weight == NULL || !(t->weight[i] > 0.0) || c->n >= RANK_MAX || !reserve(c))
        return;
    const size_t planes = t->noise_planes > 1 ? (size_t)t->noise_planes : 1;
    const double level = mean_of(t->noise + (size_t)i * planes * n, planes * n);
    c->weight[c->n] = t->weight[i];
    c->flux[c->n++] = central_flux(t->galaxy + (size_t)i * n, t->nx, t->ny, level);
}

/* Remove stamps without a positive weight. Returns the number of remaining stamps. */
static size_t keep_positive(double *weight, double *d, size_t n) {
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        if (weight[i] > 0.0) {
            weight[kept] = weight[i];
            d[kept++] = d[i];
        }
    }
    return kept;
}

rank_relation weight_check_terms(const shear_symmetry *terms) {
    const size_t n = shear_symmetry_count(terms);
    CLEANUP(release_free)
    double *values = n <= RANK_MAX ? malloc((2 * n + 1) * sizeof *values) : NULL;
    if (values == NULL)
        return (rank_relation){.correlation = NAN};
    shear_symmetry_powers(terms, values, values + n);
    return rank_relate(values, values + n, keep_positive(values, values + n, n));
}
