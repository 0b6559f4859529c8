/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "painter.h"

#include "shear_mocks/mock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A point is at most this far from the centre of its pixel. */
static const double cell_radius = 0.70710678118654757;

/* A row crosses a four-armed star in three pieces at most; one more for the grid's raggedness. */
enum { PIECES = 4, BLOCK = 4, ALIGNMENT = 64 };

/* Zeros. */
static double *new_doubles(size_t n) {
    size_t bytes = (n * sizeof(double) + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    double *made = aligned_alloc(ALIGNMENT, bytes);
    return made ? memset(made, 0, bytes) : NULL;
}

static int side_of(int half) {
    return 2 * half + 1;
}

static int spikes_half(const struct painter *p) {
    return p->kind == SHEAR_MOCK_PSF_B ? (int)ceil(psf_spikes_reach(p->r_px) + cell_radius) : -1;
}

bool painter_init(struct painter *p, int kind, double r_px, int nx, int ny) {
    *p = (struct painter){.kind = kind, .r_px = r_px, .angle_deg = NAN, .nx = nx, .ny = ny};
    p->half = (int)ceil(psf_gaussian_reach(r_px) + cell_radius);
    p->reach = (int)ceil(psf_reach(kind, r_px) + cell_radius);
    p->stride = side_of(p->half) + BLOCK - 1;
    size_t side = (size_t)side_of(p->half);
    size_t stride = (size_t)p->stride;
    p->table = new_doubles(side * stride);
    p->columns = new_doubles(stride);
    p->rows = new_doubles(side);
    p->gaussian = calloc(side, sizeof *p->gaussian);
    if (kind == SHEAR_MOCK_PSF_B) {
        size_t spikes_side = (size_t)side_of(spikes_half(p));
        p->spikes = calloc(spikes_side * PIECES, sizeof *p->spikes);
        p->buffer = new_doubles(spikes_side);
    }
    bool spikes_made = kind != SHEAR_MOCK_PSF_B || (p->spikes && p->buffer);
    return p->table && p->columns && p->rows && p->gaussian && spikes_made;
}

void painter_deinit(struct painter *p) {
    free(p->table);
    free(p->columns);
    free(p->rows);
    free(p->gaussian);
    free(p->spikes);
    free(p->buffer);
    *p = (struct painter){0};
}

/* An ellipse: what it covers of a row is one piece. */
static void find_gaussian_segments(struct painter *p) {
    int h = p->half;
    for (int j = -h; j <= h; j++) {
        struct segment s = {.j = j, .lo = -h, .hi = h};
        while (s.lo <= h && !psf_gaussian_reaches(&p->psf, s.lo, j, cell_radius)) {
            s.lo++;
        }
        while (s.hi >= s.lo && !psf_gaussian_reaches(&p->psf, s.hi, j, cell_radius)) {
            s.hi--;
        }
        p->gaussian[j + h] = s;
    }
}

/* Append column i to the pieces of row j; where the row has all it may have, the last grows over
 * the gap. */
static void add_spike_pixel(struct painter *p, int *pieces, int j, int i) {
    struct segment *last = p->spikes + p->n_spikes - 1;
    bool touches = *pieces > 0 && last->hi == i - 1;
    if (touches || *pieces == PIECES) {
        last->hi = i;
        return;
    }
    p->spikes[p->n_spikes++] = (struct segment){.j = j, .lo = i, .hi = i};
    ++*pieces;
}

static void find_spike_segments(struct painter *p) {
    int h = spikes_half(p);
    p->n_spikes = 0;
    for (int j = -h; j <= h; j++) {
        int pieces = 0;
        for (int i = -h; i <= h; i++) {
            if (psf_spikes_reach_to(&p->psf, i, j, cell_radius)) {
                add_spike_pixel(p, &pieces, j, i);
            }
        }
    }
}

void painter_turn(struct painter *p, double angle_deg) {
    if (p->angle_deg == angle_deg) {
        return;
    }
    p->angle_deg = angle_deg;
    p->psf = psf_make(p->kind, p->r_px, angle_deg);
    int side = side_of(p->half);
    for (int j = -p->half; j <= p->half; j++) {
        psf_gaussian_row(&p->psf, 1.0, -p->half, j, 1.0, side,
                         p->table + (size_t)(j + p->half) * (size_t)p->stride);
    }
    find_gaussian_segments(p);
    find_spike_segments(p);
}

/* middle[i] = first * exp(i s), at least for i = lo .. hi. */
static void fill_powers(double *middle, int lo, int hi, double first, double s) {
    double up = exp(s);
    double down = 1.0 / up;
    middle[0] = first;
    for (int i = 1; i <= hi; i++) {
        middle[i] = middle[i - 1] * up;
    }
    for (int i = -1; i >= lo; i--) {
        middle[i] = middle[i + 1] * down;
    }
}

static int max_int(int a, int b) {
    return a > b ? a : b;
}

static int min_int(int a, int b) {
    return a < b ? a : b;
}

/* row[i] += scale columns[i] table[i]. */
static void add_product(double *restrict row, double scale, const double *restrict columns,
                        const double *restrict table, int n) {
    for (int i = 0; i < n; i++) {
        row[i] += scale * (columns[i] * table[i]);
    }
}

/* The same for whole blocks: without the odd pixels at a row's end this is twice as fast. */
static void add_product_blocks(double *restrict row, double scale, const double *restrict columns,
                               const double *restrict table, int blocks) {
    for (int b = 0; b < blocks; b++) {
#pragma omp simd
        for (int i = 0; i < BLOCK; i++) { /* a constant count: no loop at all */
            int k = b * BLOCK + i;
            row[k] += scale * (columns[k] * table[k]);
        }
    }
}

/* One row: n pixels from column `lo` (relative to the point's), the first of which is image column
 * x. Rounds n up to blocks where the image has room for that: what lies beyond the segment is
 * fainter, but right. */
static void add_row(struct painter *p, int j, int lo, int n, int x, double *image_row) {
    size_t at = (size_t)(j + p->half) * (size_t)p->stride + (size_t)(lo + p->half);
    const double *table = p->table + at;
    const double *columns = p->columns + p->half + lo;
    double scale = p->rows[j + p->half];
    int blocks = (n + BLOCK - 1) / BLOCK;
    if (x + blocks * BLOCK <= p->nx) {
        add_product_blocks(image_row + x, scale, columns, table, blocks);
    } else {
        add_product(image_row + x, scale, columns, table, n);
    }
}

static void add_gaussian(struct painter *p, double amplitude, int px, int py, double dx, double dy,
                         double *image) {
    const struct psf *w = &p->psf;
    int h = p->half;
    int i_first = max_int(-h, -px);
    int i_last = min_int(h, p->nx - 1 - px);
    int j_first = max_int(-h, -py);
    int j_last = min_int(h, p->ny - 1 - py);
    double at_centre = exp(-((w->a * dx + 2.0 * w->b * dy) * dx + w->c * dy * dy));
    fill_powers(p->columns + h, i_first, i_last, 1.0, 2.0 * (w->a * dx + w->b * dy));
    fill_powers(p->rows + h, j_first, j_last, amplitude * at_centre, 2.0 * (w->b * dx + w->c * dy));
    for (int j = j_first; j <= j_last; j++) {
        const struct segment *s = &p->gaussian[j + h];
        int lo = max_int(s->lo, i_first);
        int n = min_int(s->hi, i_last) - lo + 1;
        if (n > 0) {
            add_row(p, j, lo, n, px + lo, image + (size_t)(py + j) * (size_t)p->nx);
        }
    }
}

static void add_spikes(struct painter *p, double amplitude, int px, int py, double dx, double dy,
                       double *image) {
    for (int k = 0; k < p->n_spikes; k++) {
        const struct segment *s = &p->spikes[k];
        int y = py + s->j;
        int lo = max_int(s->lo, -px);
        int n = min_int(s->hi, p->nx - 1 - px) - lo + 1;
        if (y < 0 || y >= p->ny || n <= 0) {
            continue;
        }
        psf_spikes_row(&p->psf, amplitude, lo - dx, s->j - dy, 1.0, n, p->buffer);
        double *row = image + (size_t)y * (size_t)p->nx + (px + lo);
        for (int i = 0; i < n; i++) {
            row[i] += p->buffer[i];
        }
    }
}

void painter_point(struct painter *p, double amplitude, double x, double y, double *image) {
    double px = floor(x + 0.5);
    double py = floor(y + 0.5);
    bool near = px >= -p->reach && px <= p->nx - 1 + p->reach && py >= -p->reach &&
                py <= p->ny - 1 + p->reach;
    if (!near) {
        return; /* also where x or y is not a number */
    }
    add_gaussian(p, amplitude, (int)px, (int)py, x - px, y - py, image);
    if (p->psf.spikes) {
        add_spikes(p, amplitude, (int)px, (int)py, x - px, y - py, image);
    }
}
