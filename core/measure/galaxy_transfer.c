/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/galaxy_transfer.h"

#include "base/simd.h"

#include <string.h>

/* A group of rows while T is made; from column to column along x. */
typedef struct group_rows {
    double power[FFT_LANES]; /* the target in column 0, with the factors of T */
    double right[FFT_LANES]; /* what it is multiplied by from column 0 to 1, ... */
    double left[FFT_LANES];  /* ... and from 0 to -1; */
    double bend;             /* and what these are multiplied by from column to column */
    double q2[FFT_LANES];    /* |q|^2 in column 0 */
    double lean[FFT_LANES];  /* |q|^2 = q2 + lean jx + square jx^2 */
    double square;
    double limit2;            /* T = 0 at |q|^2 >= limit2 */
    double threshold;         /* of |W|^2 */
    double lowest[FFT_LANES]; /* the smallest |q|^2 at which |W|^2 is below it */
} group_rows;

SHEAR_SIMD static void begin_rows(group_rows *g, const frame_map *map, double b2, double ux,
                                  double uy, int first, double factor) {
#pragma omp simd
    for (int l = 0; l < FFT_LANES; l++) {
        const double ky = uy * (first + l);
        g->q2[l] = map->yy * ky * ky;
        g->lean[l] = 2.0 * map->xy * ux * ky;
        g->power[l] = factor * exp(-b2 * g->q2[l]);
        g->right[l] = exp(-b2 * (g->square + g->lean[l]));
        g->left[l] = exp(-b2 * (g->square - g->lean[l]));
        g->lowest[l] = INFINITY;
    }
}

static void begin_group(group_rows *g, const transfer_plan *p, const target_aim *aim, int group) {
    const mode_plane *m = &p->plane;
    const double ux = 2.0 * M_PI / m->nx;
    const double b2 = aim->beta * aim->beta;
    g->square = aim->map.xx * ux * ux;
    g->bend = exp(-2.0 * b2 * g->square);
    g->limit2 = transfer_inside(aim->limit);
    g->threshold = p->threshold;
    begin_rows(g, &aim->map, b2, ux, 2.0 * M_PI / m->ny, group * FFT_LANES,
               target_factor(m, p->s, 1));
    if (group == 0)
        g->power[0] *= 0.5; /* row 0 is its own mirror image */
}

/* The kinds of galaxy_power. */
enum source { AMPLITUDE, POWER, TABLE };

/* Compute |W|^2 of one column of a group, from the sums of its terms. */
static SHEAR_INLINE void column_power(enum source source, const double *values, const double *c,
                                      size_t terms, double *w2) {
    double re[FFT_LANES] = {0};
    double im[FFT_LANES] = {0};
    for (size_t t = 0; t < terms && source != TABLE; t++) {
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++) {
            re[l] += c[t] * values[l];
            if (source == AMPLITUDE)
                im[l] += c[t] * values[FFT_LANES + l];
        }
        values += source == AMPLITUDE ? 2 * FFT_LANES : FFT_LANES;
    }
#pragma omp simd
    for (size_t l = 0; l < FFT_LANES; l++) {
        w2[l] = source == AMPLITUDE ? re[l] * re[l] + im[l] * im[l]
                : source == POWER   ? re[l]
                                    : values[l];
    }
}

/* Fill column jx of T, and note where |W|^2 is too small. */
static SHEAR_INLINE void fill_column(const group_rows *g, double jx, const double *power,
                                     const double *w2, double *lowest, double *t) {
#pragma omp simd
    for (size_t l = 0; l < FFT_LANES; l++) {
        const double q2 = g->q2[l] + jx * (g->lean[l] + g->square * jx);
        const double low = w2[l] >= g->threshold ? INFINITY : q2;
        lowest[l] = low < lowest[l] ? low : lowest[l];
        t[l] = q2 < g->limit2 ? power[l] / w2[l] : 0.0;
    }
}

/* The table that a group's columns come from; t and values are at column 0. */
typedef struct group_columns {
    const double *values;
    ptrdiff_t value_step; /* from column to column */
    const double *c;
    size_t terms;
    double *t;
    ptrdiff_t stride;
    int last; /* columns -last .. last */
} group_columns;

/* Fill the columns on one side of the middle. */
static SHEAR_INLINE void fill_side(enum source source, const group_rows *g, const group_columns *t,
                                   const double *first_step, int sign, double *lowest) {
    double power[FFT_LANES];
    double step[FFT_LANES];
    double w2[FFT_LANES];
#pragma omp simd
    for (size_t l = 0; l < FFT_LANES; l++) {
        power[l] = g->power[l];
        step[l] = first_step[l];
    }
    for (int j = 1; j <= t->last; j++) {
        const int jx = sign * j;
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++) {
            power[l] *= step[l];
            step[l] *= g->bend;
        }
        column_power(source, t->values + jx * t->value_step, t->c, t->terms, w2);
        fill_column(g, jx, power, w2, lowest, t->t + jx * t->stride);
    }
}

static SHEAR_INLINE void fill_columns(enum source source, group_rows *rows,
                                      const group_columns *t) {
    const group_rows g = *rows;
    double lowest[FFT_LANES];
    double w2[FFT_LANES];
#pragma omp simd
    for (size_t l = 0; l < FFT_LANES; l++)
        lowest[l] = g.lowest[l];
    column_power(source, t->values, t->c, t->terms, w2);
    fill_column(&g, 0.0, g.power, w2, lowest, t->t);
    fill_side(source, &g, t, g.right, 1, lowest);
    fill_side(source, &g, t, g.left, -1, lowest);
#pragma omp simd
    for (size_t l = 0; l < FFT_LANES; l++)
        rows->lowest[l] = lowest[l];
}

SHEAR_SIMD static void fill_from_amplitude(group_rows *g, const group_columns *t) {
    fill_columns(AMPLITUDE, g, t);
}

SHEAR_SIMD static void fill_from_power(group_rows *g, const group_columns *t) {
    fill_columns(POWER, g, t);
}

SHEAR_SIMD static void fill_from_table(group_rows *g, const group_columns *t) {
    fill_columns(TABLE, g, t);
}

/* Set T = 0 in a group's columns beyond its last one. */
static void clear_beyond(const transfer *t, const mode_plane *m, int group) {
    for (int jx = t->reach[group] + 1; jx <= t->jx; jx++) {
        double *right = t->t + mode_plane_column(m, jx) + (size_t)group * FFT_LANES;
        double *left = t->t + mode_plane_column(m, -jx) + (size_t)group * FFT_LANES;
        memset(right, 0, FFT_LANES * sizeof *right);
        memset(left, 0, FFT_LANES * sizeof *left);
    }
}

/* Fill a group of rows of T. Return the smallest |q|^2 at which |W|^2 is below the threshold. */
static double fill_group(transfer *t, const transfer_plan *p, const target_aim *aim,
                         const galaxy_power *power, int group) {
    const mode_plane *m = &p->plane;
    const psf_basis *b = power->basis;
    const size_t middle = mode_plane_column(m, 0) + (size_t)group * FFT_LANES;
    group_columns columns = {
        .t = t->t + middle, .stride = (ptrdiff_t)m->stride, .last = t->reach[group]};
    group_rows g;
    begin_group(&g, p, aim, group);
    if (b == NULL) {
        columns.values = power->table + middle;
        columns.value_step = (ptrdiff_t)m->stride;
        fill_from_table(&g, &columns);
    } else {
        columns.values = psf_basis_column(b, group);
        columns.value_step = (ptrdiff_t)psf_basis_column_size(b);
        columns.c = power->terms;
        columns.terms = (size_t)b->terms;
        (b->parts == 2 ? fill_from_amplitude : fill_from_power)(&g, &columns);
    }
    double lowest = INFINITY;
    for (int l = 0; l < FFT_LANES; l++)
        lowest = g.lowest[l] < lowest ? g.lowest[l] : lowest;
    return lowest;
}

/* Set T = 0 outside a cut that was found after T had been made. */
static void cut(transfer *t, const transfer_plan *p, const target_aim *aim) {
    const double cut2 = transfer_inside(t->k_cut);
    for (int group = 0; group * FFT_LANES <= t->jy; group++) {
        group_rows g;
        begin_group(&g, p, aim, group);
        for (int jx = -t->reach[group]; jx <= t->reach[group]; jx++) {
            double *column = t->t + mode_plane_column(&p->plane, jx) + (size_t)group * FFT_LANES;
            for (int l = 0; l < FFT_LANES; l++) {
                if (g.q2[l] + jx * (g.lean[l] + g.square * jx) >= cut2)
                    column[l] = 0.0;
            }
        }
    }
}

bool galaxy_transfer_make(transfer *t, const transfer_plan *p, const target_aim *aim,
                          const galaxy_power *power) {
    double lowest = aim->limit * aim->limit;
    t->jx = aim->jx;
    t->jy = aim->jy;
    for (int group = 0; group * FFT_LANES <= t->jy; group++) {
        t->reach[group] = target_last_jx(aim, &p->plane, aim->limit, group * FFT_LANES, aim->jx);
        clear_beyond(t, &p->plane, group);
        const double found = fill_group(t, p, aim, power, group);
        lowest = found < lowest ? found : lowest;
    }
    t->k_cut = t->k_reach = sqrt(lowest);
    if (t->k_cut < aim->limit)
        cut(t, p, aim);
    return transfer_sees(p, aim->beta, t->k_cut);
}
