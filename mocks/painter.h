/* SPDX-License-Identifier: GPL-3.0-or-later */
/* painter.h: adds point sources, convolved with a PSF, to an image. Scratch memory of one thread.
 *
 * The Gaussian of Zhang (2010), eq. (9) is evaluated without an exponential per pixel. With the
 * point at n + d (n the nearest pixel, |d| <= 1/2) and the pixel at n + (i, j), W(i - dx, j - dy) =
 * G[j][i] X^i Y^j W(d),  G[j][i] = exp -(a i^2 + 2 b i j + c j^2), ln X = 2 (a dx + b dy),  ln Y =
 * 2 (b dx + c dy): the cross term of a turned Gaussian sits in the table G alone, which does not
 * depend on the point. This identity is exact; rounding makes at most about 2 h + 200 units in the
 * last place, h the table's half side. G is cut into strips of eight columns, a vector's work each.
 * The spikes of W_B do not factor: they take an exponential per pixel, in the segments of each row
 * that they reach.
 */
#ifndef MOCKS_PAINTER_H
#define MOCKS_PAINTER_H

#include "psf.h"

#include <stdbool.h>

/* Columns lo .. hi of row j, relative to the point's pixel. */
typedef struct segment {
    int j, lo, hi;
} segment;

enum { PAINTER_STRIP = 8 }; /* columns */

/* Rows lo .. hi relative to the point's pixel; lo > hi = none. */
typedef struct row_span {
    int lo, hi;
} row_span;

typedef struct painter {
    enum shear_mock_psf kind;
    double r_px, angle_deg;
    int nx, ny;       /* of the images */
    double *canvas;   /* [ny][stride] what was painted; PAINTER_STRIP columns more on each side */
    int stride;       /* of the canvas */
    int half;         /* of the Gaussian's table */
    int reach;        /* no point farther than this from the image matters, px, at any angle */
    int n_strips;     /* that cover columns -half .. half */
    double *table;    /* G: [n_strips][2 half + 1][PAINTER_STRIP] */
    double *columns;  /* [n_strips PAINTER_STRIP] X^i */
    double *rows;     /* [n_strips PAINTER_STRIP] A W(d) Y^j */
    row_span *strips; /* [n_strips] that the Gaussian reaches */
    segment *spikes;  /* [n_spikes] */
    int n_spikes;
    double *buffer; /* one segment of spikes */
    psf_shape psf;
} painter;

/* False where there is no memory; deinit accepts what is left. */
bool painter_init(painter *p, enum shear_mock_psf kind, double r_px, int nx, int ny);
void painter_deinit(painter *p);

/* Choose the PSF's angle; needed before the first point. Costs as much as some points. */
void painter_rotate(painter *p, double angle_deg);

/* Paint amplitude * W(pixel - (x, y)). */
void painter_point(painter *p, double amplitude, double x, double y);
/* Add all that was painted to image[ny][nx], and begin the next image. */
void painter_finish(painter *p, double *image);

#endif
