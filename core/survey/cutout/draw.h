/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/draw.h: random numbers of a source, by the counter-based generator Philox4x32-10.
 *
 * The key is (chip, purpose), the counter (id of the source, plane, number): no draw depends on any
 * other, on the order of sources, or on threads. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* What a number is drawn for. The stamps depend on these numbers: never renumber. */
enum draw_purpose { DRAW_BOX = 1, DRAW_FILL, DRAW_WHITE };

/* The source that numbers are drawn for. */
typedef struct draw_key {
    int chip;
    int64_t id;
} draw_key;

/* Return number `i` of those that choose boxes, uniform in 0 .. n-1; n > 0. */
uint32_t draw_index(draw_key key, uint32_t i, uint32_t n);

/* Where to[i] is to be drawn: normal numbers with mean 0 and this standard deviation. */
typedef struct draw_normals {
    enum draw_purpose purpose;
    int plane;           /* 0: the galaxy; then the noise stamps */
    const uint8_t *mask; /* [n] 1: draw; NULL: all */
    double sigma;
    const float *sigmas; /* [n], used instead where finite, times `scale`; or NULL */
    double scale;
} draw_normals;
void draw_fill(double *to, size_t n, draw_key key, const draw_normals *what);
