/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/pixels/object_painter.h: draw which object owns a pixel, from ellipses, one band of rows
 * at a time. */
#pragma once

#include "survey/pixels/chip_pixels.h"

typedef struct object_painter {
    const object_shape *shapes; /* borrowed */
    int nx, ny, rows;           /* the chip's sides; rows of a band */
    int64_t *first;             /* [bands + 1]: members of band b are [first[b], first[b + 1]) */
    int64_t *members;           /* indices of shapes, ascending in each band */
    double *nearest; /* [rows][nx]: squared distance of a band's pixels from their owners */
} object_painter;

/* Sort the shapes into bands. SHEAR_E_FORMAT: they overlap so much that they cannot be right;
 * SHEAR_E_NOMEM. Call object_painter_deinit after an error, too. */
int object_painter_init(object_painter *p, const object_shape *shapes, int64_t n, int nx, int ny,
                        int rows, shear_error *err);
void object_painter_deinit(object_painter *p);
/* Fill owner[count][nx] for the rows of a band; 0: none. */
void object_painter_draw(object_painter *p, int band, int count, int32_t *owner);
