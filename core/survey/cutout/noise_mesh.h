/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/noise_mesh.h: the local standard deviation of the sky, in meshes of about 64 px.
 *
 * Each mesh's is that of its free pixels (no defect, no grown object) about a plane, without those
 * beyond 3 standard deviations (a normal distribution's loss is made good). Meshes without enough
 * free pixels get the mean of their neighbours, and all are smoothed over 3 x 3; both on one
 * amplifier.
 *
 * Where a weight map gives the pixels' standard deviations, these are believed up to a factor:
 * `scale` is the factor, and `level` what it makes of them; without a map they are equal. */
#pragma once

#include "base/arena.h"
#include "shear/input.h"
#include "survey/cutout/box_map.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { MESH_SIDE = 64 };

typedef struct noise_mesh {
    amplifier_axis x, y; /* of the chip */
    int columns;         /* number of meshes in x, as many as fit into each amplifier */
    int rows;            /* they begin at multiples of MESH_SIDE, and where an amplifier does */
    int first_column[SHEAR_MAX_AMPLIFIERS + 1]; /* of the meshes of amplifier i in x */
    int first_row[SHEAR_MAX_AMPLIFIERS + 1];    /* the same in y */
    bool measured, map; /* a free pixel was seen; it had a standard deviation of its own */
    double *level;      /* [rows][columns] standard deviation; NaN: the chip has no free pixels */
    double *scale;      /* [rows][columns] */
    double *scratch;    /* [rows][columns] */
    struct mesh_sample *samples; /* scratch */
} noise_mesh;

/* Place the arrays, for the axes that are set; call it with memory after a call without. */
void noise_mesh_place(noise_mesh *m, arena *a);
/* Pixels of a row of meshes, [n][x.pixels]: their rows from y on, whose cells `map` has. */
typedef struct mesh_pixels {
    const double *value;
    const float *sigma;
    const uint8_t *defect;
    int y, n;
    const box_map *map;
} mesh_pixels;
void noise_mesh_enter(noise_mesh *m, const mesh_pixels *pixels);
/* Fill gaps and smooth, once all rows are entered. */
void noise_mesh_close(noise_mesh *m);

/* Return the column of meshes of pixel column x, the row of pixel row y (of the last one beyond the
 * chip), and the index of both. */
int noise_mesh_column(const noise_mesh *m, int x);
int noise_mesh_row(const noise_mesh *m, int y);
static inline size_t noise_mesh_at(const noise_mesh *m, int x, int y) {
    return (size_t)noise_mesh_row(m, y) * (size_t)m->columns + (size_t)noise_mesh_column(m, x);
}
