/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/filter.h: the border filter of Zhang (2010), section 4.2, on a grid. */
#pragma once

#include "base/arena.h"

/* The filter sampled on n s points per side, centred periodically on the stamp's centre ((n-1)/2,
 * in pixels), with the ranges where it is not zero. Values below 1e-16 are set to zero. */
typedef struct filter_map {
    int nx, ny;               /* stamp, pixels */
    int s;                    /* samples per pixel */
    double *value;            /* [ny s][nx s] */
    int y0, y1;               /* rows outside [y0, y1) are zero */
    int *x0, *x1;             /* [ny s] columns outside [x0, x1) of a row are zero */
    int *strip_y0, *strip_y1; /* rows outside [y0, y1) of strip i are zero; its columns begin at 8
                                 i, the last strip's 8 before the end */
    double *dx2, *row;        /* [nx s, padded] scratch: squared distances along x; one row */
    double core_px, width_px; /* what the map holds; NaN: nothing yet */
    double sum;               /* of all values */
} filter_map;

void filter_map_place(filter_map *m, int nx, int ny, int s, arena *a);

/* Fill the map: 1 for r <= core, exp(-((r-core)/width)^2 / 2) beyond. Does nothing if the map
 * already holds this filter. */
void filter_map_fill(filter_map *m, double core_px, double width_px);

/* A filter on the fine grid and on the pixels, unless that is the same grid. */
typedef struct filter_pair {
    filter_map fine, coarse;
} filter_pair;

void filter_pair_place(filter_pair *f, int nx, int ny, int s, arena *a);
void filter_pair_fill(filter_pair *f, double core_px, double width_px);
/* Return the filter on the pixels. */
const filter_map *filter_pair_pixels(const filter_pair *f);

/* Return the core of filter=edge: the filter has fallen to 1e-3 at the nearest edge,
 * (min(nx,ny)-1)/2 from the centre. May be negative. */
double filter_edge_core(int nx, int ny, double width_px);
