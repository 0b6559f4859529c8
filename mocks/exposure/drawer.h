/* SPDX-License-Identifier: GPL-3.0-or-later */
/* drawer.h: draws objects into a chip's image.
 *
 * Each object has a square stamp of its own, of n pixels, n a power of two: its transform, with the
 * modes beyond the pixels' Nyquist frequency folded in, is transformed back. The only errors are
 * the modes beyond 2 pi per pixel, and light that reaches beyond the stamp and enters on the other
 * side. */
#pragma once

#include "exposure/light.h"

enum { DRAWER_MAX_SIDE = 512 };

/* The scratch memory of one thread. */
typedef struct drawer {
    double *modes;   /* [n][n] complex numbers; afterwards the stamp, in the real parts */
    double *along_x; /* [2][n] complex: phase times pixel response, of the modes 2 pi j / n ... */
    double *along_y; /* ... and those minus 2 pi */
    void *memory;    /* of all, owned */
    int n;
    int x, y; /* the stamp's first pixel in the image, from 0 */
} drawer;

/* Returns false if out of memory. */
bool drawer_init(drawer *d);
void drawer_deinit(drawer *d);

/* Choose the stamp of an object at pixel (x, y), from 0, for an accuracy of about `threshold` per
 * pixel: n, x and y. Takes no time. */
void drawer_place(drawer *d, const light *l, double x, double y, double threshold);
/* Compute the stamp that was placed for the same arguments. */
void drawer_draw(drawer *d, const light *l, double x, double y, double threshold);
/* Rows of an image [][nx], `first` up to but without `end`. */
typedef struct image_band {
    double *image;
    int nx, first, end;
} image_band;
/* Return whether the stamp reaches into the band. */
bool drawer_touches(const drawer *d, const image_band *band);
/* Add the part of the stamp that is in the band. */
void drawer_add(const drawer *d, const image_band *band);
