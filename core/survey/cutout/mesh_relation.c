/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/mesh_relation.h"

#include <math.h>

static const double least_scatter = 0.05; /* of the map's logarithms; a mesh is measured to 4 % */
static const double least_correlation = 0.8;

double mesh_relation_slope(const noise_mesh *m) {
    double n = 0.0;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (size_t i = 0; m->map && i < (size_t)m->rows * (size_t)m->columns; i++) {
        const double map = log(m->level[i] / m->scale[i]);
        const double measured = log(m->level[i]);
        if (!isfinite(map) || !isfinite(measured))
            continue;
        n++;
        x += map;
        y += measured;
        xx += map * map;
        xy += map * measured;
        yy += measured * measured;
    }
    const double cxx = xx / n - x / n * (x / n);
    const double cxy = xy / n - x / n * (y / n);
    const double cyy = yy / n - y / n * (y / n);
    const bool known = n >= 3.0 && cxx > least_scatter * least_scatter &&
                       fabs(cxy) > least_correlation * sqrt(cxx * cyy);
    return known ? cxy / cxx : NAN;
}
