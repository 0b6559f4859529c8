/* SPDX-License-Identifier: GPL-3.0-or-later */
/* painter.h: adds point sources, convolved with a PSF, to an image. Scratch memory of one thread.
 *
 * The Gaussian W_A, eq. (9) of Zhang (2010), is evaluated without an exponential per pixel. For a
 * point at n + d (n the nearest pixel, |d| <= 1/2) and the pixel at n + (i, j),
 *
 *     W(i - dx, j - dy) = G[j][i] X^i Y^j W(d),    G[j][i] = exp -(a i^2 + 2 b i j + c j^2),
 *     ln X = 2 (a dx + b dy),    ln Y = 2 (b dx + c dy).
 *
 * The cross term of a rotated Gaussian is only in the table G, which does not depend on the point.
 * The identity is exact; rounding errors are at most about 2 h + 200 units in the last place, where
 * h is the table's half side. G is stored in strips of eight columns, for vector instructions. The
 * spikes of W_B do not factorise: they take an exponential per pixel, in the segments of each row
 * that they reach.
 */
#pragma once

#include "psf.h"

#include <stdbool.h>

/* Columns lo .. hi of row j, relative to the point's pixel. */
typedef struct segment {
    int j, lo, hi;
} segment;

enum { PAINTER_STRIP = 8 }; /* columns */

/* Rows lo .. hi relative to the point's pixel; none if lo > hi. */
typedef struct row_span {
    int lo, hi;
} row_span;

typedef struct painter {
    enum shear_mock_psf kind;
    double r_px, angle_deg;
    int nx, ny; /* of the images */
    double
        *canvas;   /* [ny][stride] the image so far, with PAINTER_STRIP more columns on each side */
    int stride;    /* of the canvas */
    int half;      /* of the Gaussian's table */
    int reach;     /* largest distance of a point from the image that matters, px, at any angle */
    int n_strips;  /* to cover columns -half .. half */
    double *table; /* G: [n_strips][2 half + 1][PAINTER_STRIP] */
    double *columns;  /* [n_strips PAINTER_STRIP] X^i */
    double *rows;     /* [n_strips PAINTER_STRIP] A W(d) Y^j */
    row_span *strips; /* [n_strips] rows that the Gaussian reaches */
    segment *spikes;  /* [n_spikes] */
    int n_spikes;
    double *buffer; /* for one segment of spikes */
    void *memory;   /* of all these arrays, owned */
    psf_shape psf;
} painter;

/* Initialize for images [ny][nx]. Returns false if out of memory; call painter_deinit in either
 * case. */
bool painter_init(painter *p, enum shear_mock_psf kind, double r_px, int nx, int ny);
void painter_deinit(painter *p);

/* Set the PSF's angle; required before the first point. Takes as long as painting some points. */
void painter_rotate(painter *p, double angle_deg);

/* Paint amplitude * W(pixel - (x, y)). */
void painter_point(painter *p, double amplitude, double x, double y);
/* Add the painted points to image[ny][nx], and clear the canvas. */
void painter_finish(painter *p, double *image);
