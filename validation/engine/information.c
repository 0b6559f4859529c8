/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/information.h"

#include <math.h>

static const double bin_width = 0.02;
static const double class_width = 0.2; /* width in ln D */
static const double fewest = 10.0;     /* minimum number of counts in a bin that is used */

static void count(double *bins, double size) {
    const double bin = size / bin_width;
    if (bin < SHAPE_BINS)
        bins[(int)bin] += 1.0;
}

void shape_counts_add(shape_counts *c, double d, double e1, double e2) {
    if (!(d > 0.0))
        return;
    const double at = floor(log(d) / class_width + 0.5 * SHAPE_CLASSES);
    const int k = (int)fmax(0.0, fmin(SHAPE_CLASSES - 1, at));
    count(c->line[k], fabs(e1));
    count(c->line[k], fabs(e2));
    count(c->plane[k], hypot(e1, e2));
}

/* Return the sum over bins of area * (slope^2 - its noise) / density; areas [SHAPE_BINS]. The
 * distribution is even, so the first bin is its own predecessor. */
static double information(const double *counts, const double *areas) {
    double sum = 0.0;
    for (int i = 0; i + 1 < SHAPE_BINS; i++) {
        const int before = i > 0 ? i - 1 : 0;
        const int after = i + 1;
        const double slope = counts[after] / areas[after] - counts[before] / areas[before];
        const double noise = counts[after] / (areas[after] * areas[after]) +
                             counts[before] / (areas[before] * areas[before]);
        const double density = counts[i] / areas[i];
        if (counts[i] >= fewest)
            sum += areas[i] * (slope * slope - noise) / (4.0 * bin_width * bin_width) / density;
    }
    return sum;
}

/* Return 1/sqrt(part * the mean information of a galaxy). */
static double bound(const double counts[SHAPE_CLASSES][SHAPE_BINS], const double *areas,
                    double part) {
    double total = 0.0;
    double sum = 0.0;
    for (int k = 0; k < SHAPE_CLASSES; k++) {
        for (int i = 0; i < SHAPE_BINS; i++)
            total += counts[k][i];
        sum += information(counts[k], areas);
    }
    return 1.0 / sqrt(part * sum / total);
}

double shape_bound_line(const shape_counts *c) {
    double areas[SHAPE_BINS];
    for (int i = 0; i < SHAPE_BINS; i++)
        areas[i] = bin_width;
    return bound(c->line, areas, 1.0);
}

/* One component contributes half of the gradient's square. */
double shape_bound_plane(const shape_counts *c) {
    double areas[SHAPE_BINS];
    for (int i = 0; i < SHAPE_BINS; i++) {
        areas[i] = (2 * i + 1) * bin_width * bin_width; /* divided by pi */
    }
    return bound(c->plane, areas, 0.5);
}
