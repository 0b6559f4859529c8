/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/pixels/object_painter.h"

#include "base/cleanup.h"
#include "base/simd.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Shorter axes would miss the centres of all pixels, longer ones are wrong. */
static const double least_axis = 0.75;
static const double most_axis = 1e5;
/* Ellipses that a pixel may lie in, on average. More are no catalog of this image, and would take
 * hours. */
static const double most_layers = 200.0;

/* An ellipse: xx dx^2 + 2 xy dx dy + yy dy^2 <= 1, and its half sides. */
typedef struct ellipse {
    double x, y, xx, xy, yy, half_x, half_y;
} ellipse;

/* Return whether the shape is one. */
static bool set_ellipse(ellipse *e, const object_shape *s) {
    if (!(isfinite(s->x) && isfinite(s->y) && isfinite(s->theta) && s->a > 0.0 && s->b > 0.0) ||
        s->owner <= 0) {
        return false;
    }
    const double a = fmin(fmax(s->a, least_axis), most_axis);
    const double b = fmin(fmax(s->b, least_axis), most_axis);
    const double c2 = cos(s->theta) * cos(s->theta);
    const double s2 = 1.0 - c2;
    e->x = s->x;
    e->y = s->y;
    e->xx = c2 / (a * a) + s2 / (b * b);
    e->yy = s2 / (a * a) + c2 / (b * b);
    e->xy = cos(s->theta) * sin(s->theta) * (1.0 / (a * a) - 1.0 / (b * b));
    e->half_x = sqrt(a * a * c2 + b * b * s2);
    e->half_y = sqrt(a * a * s2 + b * b * c2);
    return true;
}

/* The pixels of one axis, of n, that lie within `half` of the centre. */
typedef struct span {
    int low, high; /* low > high: none */
} span;

static span pixels_within(double centre, double half, int n) {
    const double low = fmax(ceil(centre - half), 0.0);
    const double high = fmin(floor(centre + half), n - 1.0);
    return low <= high ? (span){(int)low, (int)high} : (span){1, 0};
}

/* ---- sorting into bands ---- */

/* Count the shapes of each band into first[band + 1], or, once first[] holds the places, add them.
 */
static void sort_shapes(object_painter *p, int64_t n, double *area) {
    for (int64_t i = 0; i < n; i++) {
        ellipse e;
        if (!set_ellipse(&e, &p->shapes[i]))
            continue;
        const span x = pixels_within(e.x, e.half_x, p->nx);
        const span y = pixels_within(e.y, e.half_y, p->ny);
        if (x.low > x.high || y.low > y.high)
            continue;
        *area += (x.high - x.low + 1.0) * (y.high - y.low + 1.0);
        for (int band = y.low / p->rows; band <= y.high / p->rows; band++) {
            if (p->members != NULL)
                p->members[p->first[band]] = i;
            p->first[band + (p->members == NULL ? 1 : 0)]++;
        }
    }
}

static int out_of_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
}

int object_painter_init(object_painter *p, const object_shape *shapes, int64_t n, int nx, int ny,
                        int rows, shear_error *err) {
    const size_t bands = ((size_t)ny - 1) / (size_t)rows + 1;
    double area = 0.0;
    *p = (object_painter){.shapes = shapes, .nx = nx, .ny = ny, .rows = rows};
    p->first = calloc(bands + 1, sizeof *p->first);
    p->nearest = malloc((size_t)nx * (size_t)rows * sizeof *p->nearest);
    if (p->first == NULL || p->nearest == NULL)
        return out_of_memory(err);
    sort_shapes(p, n, &area);
    if (area > most_layers * nx * ny) {
        return shear_fail(err, SHEAR_E_FORMAT,
                          "are the axes of the objects in pixels? give a segmentation image else",
                          "the ellipses of the objects cover each pixel %.0f times",
                          area / nx / ny);
    }
    for (size_t b = 0; b < bands; b++)
        p->first[b + 1] += p->first[b];
    p->members = malloc(((size_t)p->first[bands] + 1) * sizeof *p->members);
    if (p->members == NULL)
        return out_of_memory(err);
    sort_shapes(p, n, &area);
    memmove(p->first + 1, p->first, bands * sizeof *p->first); /* each is now the next one's */
    p->first[0] = 0;
    return SHEAR_OK;
}

void object_painter_deinit(object_painter *p) {
    free(p->first);
    free(p->members);
    free(p->nearest);
    *p = (object_painter){0};
}

/* ---- drawing ---- */

/* Give the pixels [x.low, x.high] of a row, dy from the centre, to the object if it is nearest. */
SHEAR_SIMD static void draw_row(const ellipse *e, span x, double dy, int32_t number,
                                double *restrict nearest, int32_t *restrict owner) {
    const double xx = e->xx;
    const double xy = 2.0 * e->xy * dy;
    const double yy = e->yy * dy * dy;
    const double centre = e->x;
#pragma omp simd
    for (int i = x.low; i <= x.high; i++) {
        const double dx = i - centre;
        const double r2 = (xx * dx + xy) * dx + yy;
        const bool mine = r2 < nearest[i];
        nearest[i] = mine ? r2 : nearest[i];
        owner[i] = mine ? number : owner[i];
    }
}

/* Return the pixels of a row that the ellipse may reach, dy from its centre; one too many does no
 * harm. */
static span reach(const ellipse *e, double dy, int nx) {
    const double middle = -e->xy * dy / e->xx;
    const double square = middle * middle - (e->yy * dy * dy - 1.0) / e->xx;
    return pixels_within(e->x + middle, sqrt(fmax(square, 0.0)) + 1.0, nx);
}

static void draw(object_painter *p, const object_shape *shape, int first_row, int count,
                 int32_t *owner) {
    ellipse e;
    if (!set_ellipse(&e, shape))
        return;
    const span y = pixels_within(e.y - first_row, e.half_y, count);
    for (int row = y.low; row <= y.high; row++) {
        const double dy = first_row + row - e.y;
        const size_t at = (size_t)row * (size_t)p->nx;
        draw_row(&e, reach(&e, dy, p->nx), dy, shape->owner, p->nearest + at, owner + at);
    }
}

void object_painter_draw(object_painter *p, int band, int count, int32_t *owner) {
    const size_t n = (size_t)count * (size_t)p->nx;
    memset(owner, 0, n * sizeof *owner);
    if (p->first[band] == p->first[band + 1])
        return;
    for (size_t i = 0; i < n; i++)
        p->nearest[i] = 1.0;
    for (int64_t i = p->first[band]; i < p->first[band + 1]; i++)
        draw(p, &p->shapes[p->members[i]], band * p->rows, count, owner);
}
