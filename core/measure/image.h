/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/image.h: a stamp (or PSF) on its way to the fine grid, one fine row at a time. */
#ifndef SHEAR_IMAGE_H
#define SHEAR_IMAGE_H

#include "measure/axis.h"
#include "shear/settings.h"

/* How images of one shape are interpolated; immutable, shared by threads. */
typedef struct image_grid {
    axis x, y;
    bool log;  /* interpolate ln(pixel + pedestal) */
    int zeros; /* enum shear_zeros, where log */
    double pedestal;
    int fine_nx, fine_ny;
    size_t stride; /* numbers in a line of the scratch arrays, >= fine_nx */
} image_grid;

/* interpolation: never AUTO. false when memory is out; deinit is safe then too. */
bool image_grid_init(image_grid *g, int nx, int ny, int interpolation, int s, int zeros,
                     double pedestal);
void image_grid_deinit(image_grid *g);

/* One image's scratch: rows already fine along x, still coarse along y. */
typedef struct image {
    const double *pixels; /* [ny][nx] of the image being worked on */
    double *f;            /* [ny][stride] values, or logarithms */
    double *e;            /* [ny][stride] slopes along y */
    double *surface;      /* [5][ny][nx] values, slopes and mixed slopes at the pixels */
    bool marked;          /* f holds marks: zeros under zeros=skip */
} image;
bool image_init(image *im, const image_grid *g);
void image_deinit(image *im);

/* Take up the pixels [ny][nx] (kept by the caller until the rows have been read). false where a log
 * method meets a negative number: pixel (*bad_x, *bad_y). */
bool image_load(image *im, const image_grid *g, const double *pixels, int *bad_x, int *bad_y);

/* Fine row `fine_y`, columns [x0, x1): made in scratch[0 .. x1-x0), or the pixels where they are.
 */
const double *image_row_view(const image *im, const image_grid *g, int fine_y, int x0, int x1,
                             double *scratch);
/* What the unmarked fine row `fine_y` is made of, where the interpolation has slopes and takes
 * logarithms: exp(w.a fj[x] + w.b fk[x] + w.c ej[x] + w.d ek[x]) - pedestal. */
typedef struct log_row {
    axis_weights w;
    const double *fj, *fk, *ej, *ek;
} log_row;
bool image_is_smooth_log(const image *im, const image_grid *g);
log_row image_log_row(const image *im, const image_grid *g, int fine_y);
/* Fine row `fine_y`, columns [x0, x1), always into out. */
void image_row(const image *im, const image_grid *g, int fine_y, int x0, int x1, double *out);

#endif
