/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/filter.h: the border filter of Zhang (2010), section 4.2, on a grid. */
#ifndef SHEAR_MEASURE_FILTER_H
#define SHEAR_MEASURE_FILTER_H

#include <stdbool.h>
#include <stddef.h>

/* The filter sampled on n s points a side, periodically centred on the stamp's centre ((n-1)/2, in
 * pixels), and where it is not zero. Values below 1e-16 are zero. */
typedef struct filter_map {
    int nx, ny;               /* stamp, pixels */
    int s;                    /* samples per pixel */
    double *value;            /* [ny s][nx s] */
    int y0, y1;               /* rows outside [y0, y1) are zero */
    int *x0, *x1;             /* [ny s] columns outside [x0, x1) of a row are zero */
    int *strip_y0, *strip_y1; /* rows outside [y0, y1) of strip i are zero: the columns from 8 i, or
                                 the last 8 */
    double *dx2, *row;        /* [nx s, padded] squares along x, scratch */
    double core_px, width_px; /* what it holds; NaN: nothing yet */
    double sum;               /* of all values */
} filter_map;

bool filter_map_init(filter_map *m, int nx, int ny, int s); /* false when memory is out */
void filter_map_deinit(filter_map *m);

/* Fill it: 1 for r <= core, exp(-((r-core)/width)^2 / 2) beyond. Does nothing where it holds that
 * already. */
void filter_map_fill(filter_map *m, double core_px, double width_px);

/* The core of filter=edge: fallen to 1e-3 at the nearest edge, (min(nx,ny)-1)/2 from the centre.
 * May be negative. */
double filter_edge_core(int nx, int ny, double width_px);

#endif
