/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/half_light.h"

#include "base/cleanup.h"
#include "base/sort.h"

#include <math.h>
#include <stdlib.h>

enum { FEWEST = 20, HALVINGS = 16 };

static const double CLUMP = 1.05;

/* The centre of what is brighter than half the peak. */
typedef struct centre {
    double x, y;
} centre;

static centre centre_of(const double *image, int nx, int ny) {
    double peak = 0.0;
    double sum = 0.0;
    centre c = {0.0, 0.0};
    for (int k = 0; k < nx * ny; k++)
        peak = fmax(peak, image[k]);
    for (int k = 0; k < nx * ny; k++) {
        const double above = fmax(image[k] - 0.5 * peak, 0.0);
        sum += above;
        c.x += above * (k % nx);
        c.y += above * (k / nx); /* NOLINT(bugprone-integer-division) */
    }
    return (centre){c.x / sum, c.y / sum}; /* NaN without light */
}

/* Return the light within r. A sample at its edge counts in part. */
static double light_within(const double *image, int nx, int ny, centre c, double r) {
    double sum = 0.0;
    for (int j = 0; j < ny; j++) {
        for (int i = 0; i < nx; i++) {
            const double part = r + 0.5 - hypot(i - c.x, j - c.y);
            sum += fmin(fmax(part, 0.0), 1.0) * image[(ptrdiff_t)j * nx + i];
        }
    }
    return sum;
}

double half_light_of_image(const double *image, int nx, int ny) {
    const centre c = centre_of(image, nx, ny);
    const double all = light_within(image, nx, ny, c, nx + ny);
    double low = 0.0;
    double high = nx + ny;
    for (int i = 0; i < HALVINGS; i++) {
        const double r = 0.5 * (low + high);
        if (light_within(image, nx, ny, c, r) < 0.5 * all) {
            low = r;
        } else {
            high = r;
        }
    }
    return all > 0.0 ? low : NAN;
}

/* Collect the FLUX_RADIUS of sources that are selected, or not, and sort them. */
static size_t collect(double *size, const source_list *s, bool selected) {
    size_t n = 0;
    for (int64_t i = 0; i < s->n; i++) {
        if (s->r_gal[i] > 0.0 && (s->selected[i] != 0) == selected)
            size[n++] = 0.5 * s->r_gal[i];
    }
    sort_doubles(size, n);
    return n;
}

/* Return whether sizes are as equal as those of stars around their lower quartile: faint stars
 * scatter below it, saturated ones and blends above. */
static bool is_clump(const double *size, size_t n) {
    return size[3 * n / 8] < CLUMP * size[n / 8];
}

double half_light_of_stars(const source_list *sources) {
    if (sources->r_gal == NULL || !sources->r_gal_measured)
        return NAN;
    CLEANUP(release_free) double *size = malloc(((size_t)sources->n + 1) * sizeof *size);
    if (size == NULL)
        return NAN;
    const size_t galaxies = collect(size, sources, true);
    const double small = galaxies > 0 ? size[galaxies / 10] : 0.0;
    const size_t others = collect(size, sources, false);
    return others >= FEWEST && size[others / 2] < small && is_clump(size, others) ? size[others / 4]
                                                                                  : NAN;
}
