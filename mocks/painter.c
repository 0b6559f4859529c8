/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "painter.h"

#include "base/arena.h"
#include "base/simd.h"
#include "shear_mocks/mock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* maximum distance of a point from the centre of its pixel, px */
static const double cell_radius = 0.70710678118654757;

/* A row crosses a four-armed star in at most three pieces; one more because of the grid. */
enum { PIECES = 4 };

static int side_of(int half) {
    return 2 * half + 1;
}

static int spikes_half(const painter *p) {
    return p->kind == SHEAR_MOCK_PSF_B ? (int)ceil(psf_spikes_reach(p->r_px) + cell_radius) : -1;
}

static void place(painter *p, arena *a) {
    const size_t side = (size_t)side_of(p->half);
    const size_t width = (size_t)p->n_strips * PAINTER_STRIP;
    const size_t spikes =
        p->kind == SHEAR_MOCK_PSF_B ? (size_t)side_of(spikes_half(p)) + PAINTER_STRIP : 0;
    p->canvas = arena_doubles(a, (size_t)p->stride * (size_t)p->ny);
    p->table = arena_doubles(a, side * width);
    p->columns = arena_doubles(a, width);
    p->rows = arena_doubles(a, width);
    p->strips = arena_take(a, (size_t)p->n_strips * sizeof *p->strips);
    p->spikes = arena_take(a, spikes * PIECES * sizeof *p->spikes);
    p->buffer = arena_doubles(a, spikes);
}

bool painter_init(painter *p, enum shear_mock_psf kind, double r_px, int nx, int ny) {
    arena a = {0};
    *p = (painter){.kind = kind, .r_px = r_px, .angle_deg = NAN, .nx = nx, .ny = ny};
    p->half = (int)ceil(psf_gaussian_reach(r_px) + cell_radius);
    p->reach = (int)ceil(psf_reach(kind, r_px) + cell_radius);
    p->n_strips = (side_of(p->half) + PAINTER_STRIP - 1) / PAINTER_STRIP;
    p->stride = nx + 2 * PAINTER_STRIP;
    place(p, &a);
    p->memory = arena_allocate(&a);
    if (p->memory == NULL)
        return false;
    place(p, &a);
    return true;
}

void painter_deinit(painter *p) {
    free(p->memory);
    *p = (painter){0};
}

/* Fill the rows of G in one strip, with zeros where the Gaussian does not reach. Only the rows from
 * lo to hi of p->strips are used. */
static void fill_strip(painter *p, int strip) {
    int h = p->half;
    int first = strip * PAINTER_STRIP - h;
    double *row = p->table + (size_t)strip * (size_t)side_of(h) * PAINTER_STRIP;
    row_span *reached = &p->strips[strip];
    *reached = (row_span){.lo = h + 1, .hi = -h - 1};
    for (int j = -h; j <= h; j++, row += PAINTER_STRIP) {
        psf_gaussian_row(&p->psf, 1.0, first, j, 1.0, PAINTER_STRIP, row);
        bool any = false;
        for (int i = 0; i < PAINTER_STRIP; i++) {
            bool reaches = psf_gaussian_reaches(&p->psf, first + i, j, cell_radius);
            row[i] = reaches ? row[i] : 0.0;
            any = any || reaches;
        }
        if (any) {
            reached->lo = j < reached->lo ? j : reached->lo;
            reached->hi = j;
        }
    }
}

/* Append column i to the pieces of row j. If the row already has the maximum number of pieces,
 * extend the last one over the gap. */
static void add_spike_pixel(painter *p, int *pieces, int j, int i) {
    segment *last = p->spikes + p->n_spikes - 1;
    bool touches = *pieces > 0 && last->hi == i - 1;
    if (touches || *pieces == PIECES) {
        last->hi = i;
        return;
    }
    p->spikes[p->n_spikes++] = (segment){.j = j, .lo = i, .hi = i};
    ++*pieces;
}

static void find_spike_segments(painter *p) {
    int h = spikes_half(p);
    p->n_spikes = 0;
    for (int j = -h; j <= h; j++) {
        int pieces = 0;
        for (int i = -h; i <= h; i++) {
            if (psf_spikes_reach_to(&p->psf, i, j, cell_radius))
                add_spike_pixel(p, &pieces, j, i);
        }
    }
}

void painter_rotate(painter *p, double angle_deg) {
    if (p->angle_deg == angle_deg)
        return;
    p->angle_deg = angle_deg;
    p->psf = psf_make(p->kind, p->r_px, angle_deg);
    for (int strip = 0; strip < p->n_strips; strip++)
        fill_strip(p, strip);
    find_spike_segments(p);
}

/* Set out[i] = scale * exp(first + i s), for n strips of i. */
SHEAR_SIMD static void fill_powers(double *out, int n, double scale, double first, double s) {
    double x = exp(s);
    double x2 = x * x;
    double x4 = x2 * x2;
    double x8 = x4 * x4;
    double y = scale * exp(first);
    double power[PAINTER_STRIP];
#pragma omp simd
    for (int i = 0; i < PAINTER_STRIP; i++)
        power[i] = (y * (i & 4 ? x4 : 1.0)) * ((i & 2 ? x2 : 1.0) * (i & 1 ? x : 1.0));
    for (int k = 0; k < n; k++) {
#pragma omp simd
        for (int i = 0; i < PAINTER_STRIP; i++) {
            out[k * PAINTER_STRIP + i] = power[i];
            power[i] *= x8;
        }
    }
}

static int max_int(int a, int b) {
    return a > b ? a : b;
}

static int min_int(int a, int b) {
    return a < b ? a : b;
}

/* Add n rows of a strip: canvas[j][i] += rows[j] columns[i] table[j][i]. The constant number of
 * columns lets the compiler keep them in registers. */
SHEAR_SIMD static void add_strip(double *restrict canvas, size_t stride,
                                 const double *restrict columns, const double *restrict rows,
                                 const double *restrict table, int n) {
    for (int j = 0; j < n; j++) {
        double *to = canvas + (size_t)j * stride;
        const double *from = table + (size_t)j * PAINTER_STRIP;
#pragma omp simd
        for (int i = 0; i < PAINTER_STRIP; i++)
            to[i] += rows[j] * (columns[i] * from[i]);
    }
}

/* Paint whole strips, into the canvas's margins if necessary. */
static void add_gaussian(painter *p, double amplitude, int px, int py, double dx, double dy) {
    const psf_shape *w = &p->psf;
    int h = p->half;
    int j_first = max_int(-h, -py);
    int j_last = min_int(h, p->ny - 1 - py);
    double at_centre = -((w->a * dx + 2.0 * w->b * dy) * dx + w->c * dy * dy);
    double ln_x = 2.0 * (w->a * dx + w->b * dy);
    double ln_y = 2.0 * (w->b * dx + w->c * dy);
    fill_powers(p->columns, p->n_strips, 1.0, -h * ln_x, ln_x);
    fill_powers(p->rows, p->n_strips, amplitude, at_centre - h * ln_y, ln_y);
    for (int strip = 0; strip < p->n_strips; strip++) {
        int x = px - h + strip * PAINTER_STRIP;
        int lo = max_int(p->strips[strip].lo, j_first);
        int n = min_int(p->strips[strip].hi, j_last) - lo + 1;
        if (x > -PAINTER_STRIP && x < p->nx && n > 0) {
            size_t row = (size_t)strip * (size_t)side_of(h) + (size_t)(lo + h);
            add_strip(p->canvas + (size_t)(py + lo) * (size_t)p->stride + (x + PAINTER_STRIP),
                      (size_t)p->stride, p->columns + (size_t)strip * PAINTER_STRIP,
                      p->rows + h + lo, p->table + row * PAINTER_STRIP, n);
        }
    }
}

static void add_spikes(painter *p, double amplitude, int px, int py, double dx, double dy) {
    for (int k = 0; k < p->n_spikes; k++) {
        const segment *s = &p->spikes[k];
        int y = py + s->j;
        int lo = max_int(s->lo, -px);
        int n = min_int(s->hi, p->nx - 1 - px) - lo + 1;
        if (y < 0 || y >= p->ny || n <= 0)
            continue;
        /* whole strips: the exponentials of a remainder would not be vectorised */
        int whole = (n + PAINTER_STRIP - 1) / PAINTER_STRIP * PAINTER_STRIP;
        psf_spikes_row(&p->psf, amplitude, lo - dx, s->j - dy, 1.0, whole, p->buffer);
        double *row = p->canvas + (size_t)y * (size_t)p->stride + (px + lo + PAINTER_STRIP);
        for (int i = 0; i < n; i++)
            row[i] += p->buffer[i];
    }
}

void painter_point(painter *p, double amplitude, double x, double y) {
    double px = floor(x + 0.5);
    double py = floor(y + 0.5);
    bool near = px >= -p->reach && px <= p->nx - 1 + p->reach && py >= -p->reach &&
                py <= p->ny - 1 + p->reach;
    if (!near) {
        return; /* also if x or y is NaN */
    }
    add_gaussian(p, amplitude, (int)px, (int)py, x - px, y - py);
    if (p->psf.spikes)
        add_spikes(p, amplitude, (int)px, (int)py, x - px, y - py);
}

void painter_finish(painter *p, double *image) {
    for (int y = 0; y < p->ny; y++) {
        const double *from = p->canvas + (size_t)y * (size_t)p->stride + PAINTER_STRIP;
        double *to = image + (size_t)y * (size_t)p->nx;
        for (int x = 0; x < p->nx; x++)
            to[x] += from[x];
    }
    memset(p->canvas, 0, (size_t)p->stride * (size_t)p->ny * sizeof *p->canvas);
}
