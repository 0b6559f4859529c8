/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/filter.h"

#include <math.h>
#include <stdlib.h>

static const double zero_below = 1e-16; /* less than the rounding of what it multiplies */
static const double edge_value = 1e-3;

bool filter_map_init(filter_map *m, int nx, int ny, int s) {
    const size_t rows = (size_t)ny * (size_t)s;
    *m = (filter_map){.nx = nx, .ny = ny, .s = s, .core_px = NAN, .width_px = NAN};
    m->value = malloc(rows * (size_t)nx * (size_t)s * sizeof *m->value);
    m->x0 = malloc(rows * sizeof *m->x0);
    m->x1 = malloc(rows * sizeof *m->x1);
    return m->value != NULL && m->x0 != NULL && m->x1 != NULL;
}

void filter_map_deinit(filter_map *m) {
    free(m->value);
    free(m->x0);
    free(m->x1);
    *m = (filter_map){0};
}

/* Distance in pixels of fine point `fine` from the centre of n pixels, along one axis of the
 * periodic grid. */
static double from_centre(int fine, int n, int s) {
    const double d = (double)fine / s - 0.5 * (n - 1);
    return d > 0.5 * n ? d - n : d;
}

static double window(double r, double core, double width) {
    const double x = (r - core) / width;
    return x <= 0.0 ? 1.0 : exp(-0.5 * x * x);
}

/* Fill row `fine_y`; whether anything in it is not zero. */
static bool fill_row(filter_map *m, int fine_y) {
    const int n = m->nx * m->s;
    const double dy = from_centre(fine_y, m->ny, m->s);
    double *row = m->value + (size_t)fine_y * (size_t)n;
    int first = n;
    int last = -1;
    for (int i = 0; i < n; i++) {
        const double dx = from_centre(i, m->nx, m->s);
        const double v = window(sqrt(dx * dx + dy * dy), m->core_px, m->width_px);
        row[i] = v < zero_below ? 0.0 : v;
        if (row[i] > 0.0) {
            first = i < first ? i : first;
            last = i;
        }
    }
    m->x0[fine_y] = last >= 0 ? first : 0;
    m->x1[fine_y] = last + 1;
    return last >= 0;
}

void filter_map_fill(filter_map *m, double core_px, double width_px) {
    if (m->core_px == core_px && m->width_px == width_px) {
        return;
    }
    m->core_px = core_px;
    m->width_px = width_px;
    m->y0 = m->ny * m->s;
    m->y1 = 0;
    for (int y = 0; y < m->ny * m->s; y++) {
        if (fill_row(m, y)) {
            m->y0 = y < m->y0 ? y : m->y0;
            m->y1 = y + 1;
        }
    }
}

double filter_edge_core(int nx, int ny, double width_px) {
    const double edge = 0.5 * ((nx < ny ? nx : ny) - 1);
    return edge - width_px * sqrt(-2.0 * log(edge_value));
}
