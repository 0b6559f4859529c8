/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/psf_basis.h"

#include "base/cleanup.h"
#include "base/simd.h"
#include "measure/lanczos.h"

#include <stdlib.h>

/* Return the values of one column of a group. */
static size_t column_size(const psf_basis *b) {
    return (size_t)b->terms * (size_t)b->parts * FFT_LANES;
}

static int reach_of(const mode_plane *p, int group) {
    const double ky = 2.0 * M_PI / p->ny * group * FFT_LANES;
    const double left = p->k_limit * p->k_limit - ky * ky;
    const int jx = left > 0.0 ? (int)(sqrt(left) * p->nx / (2.0 * M_PI)) : 0;
    return jx < p->max_jx ? jx : p->max_jx;
}

void psf_basis_place(psf_basis *b, const mode_plane *p, const shear_psf_model *m, arena *a) {
    *b = (psf_basis){.terms = m->terms,
                     .parts = m->axes == SHEAR_PSF_AXES_MODES ? 1 : 2,
                     .groups = (int)(p->stride / FFT_LANES)};
    size_t columns = 0;
    for (int group = 0; group < b->groups; group++)
        columns += 2 * (size_t)reach_of(p, group) + 1;
    b->reach = arena_take(a, (size_t)b->groups * sizeof *b->reach);
    b->flux = arena_doubles(a, (size_t)m->terms);
    b->values = arena_doubles(a, columns * column_size(b));
}

/* ---- transforms ---- */

/* exp(-i k r) of n samples about their middle, times the kernel's transform, for modes jx = first
 * .. first + count - 1: [mode][n]. */
typedef struct waves {
    double *re, *im;
    int n;
} waves;

static void waves_fill(waves *w, double unit, int first, int count, const shear_psf_model *m) {
    for (int j = 0; j < count; j++) {
        const double phase = unit * (first + j) * m->step; /* radians per sample */
        const double kernel = m->lanczos > 0 ? lanczos_transform(m->lanczos, phase) : 1.0;
        for (int i = 0; i < w->n; i++) {
            const double x = phase * (i - 0.5 * (w->n - 1));
            w->re[(size_t)j * (size_t)w->n + (size_t)i] = kernel * cos(x);
            w->im[(size_t)j * (size_t)w->n + (size_t)i] = -kernel * sin(x);
        }
    }
}

/* Scratch of a model's transform. */
typedef struct separable {
    waves x, y;              /* [2 max_jx + 1][nx], [stride][ny] */
    double *row_re, *row_im; /* [FFT_LANES][nx] a group of rows, transformed along y */
} separable;

static void separable_place(separable *s, const mode_plane *p, const shear_psf_model *m, arena *a) {
    const size_t nx = (size_t)m->nx;
    const size_t ny = (size_t)m->ny;
    const size_t columns = 2 * (size_t)p->max_jx + 1;
    s->x = (waves){arena_doubles(a, columns * nx), arena_doubles(a, columns * nx), m->nx};
    s->y = (waves){arena_doubles(a, p->stride * ny), arena_doubles(a, p->stride * ny), m->ny};
    s->row_re = arena_doubles(a, FFT_LANES * nx);
    s->row_im = arena_doubles(a, FFT_LANES * nx);
}

/* Add `re + i im` times n samples. */
SHEAR_SIMD static void add_samples(const double *samples, double re, double im, size_t n,
                                   double *sum_re, double *sum_im) {
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        sum_re[i] += re * samples[i];
        sum_im[i] += im * samples[i];
    }
}

/* Return the real and the imaginary part of sum_i (a + ib)(c + id). */
SHEAR_SIMD static void multiply(const double *a, const double *b, const double *c, const double *d,
                                size_t n, double *re, double *im) {
    double sum_re = 0.0;
    double sum_im = 0.0;
#pragma omp simd reduction(+ : sum_re, sum_im)
    for (size_t i = 0; i < n; i++) {
        sum_re += a[i] * c[i] - b[i] * d[i];
        sum_im += a[i] * d[i] + b[i] * c[i];
    }
    *re = sum_re;
    *im = sum_im;
}

static void transform_along_y(const separable *s, const shear_psf_model *m, const double *samples,
                              int group) {
    const size_t nx = (size_t)m->nx;
    for (size_t l = 0; l < FFT_LANES; l++) {
        double *re = s->row_re + l * nx;
        double *im = s->row_im + l * nx;
        const size_t row = ((size_t)group * FFT_LANES + l) * (size_t)m->ny;
        for (size_t x = 0; x < nx; x++)
            re[x] = im[x] = 0.0;
        for (size_t y = 0; y < (size_t)m->ny; y++)
            add_samples(samples + y * nx, s->y.re[row + y], s->y.im[row + y], nx, re, im);
    }
}

/* Fill term t of the columns of a group, which begin at `values`. */
static void transform_along_x(const psf_basis *b, const separable *s, const mode_plane *p,
                              int group, int t, double *values) {
    const size_t nx = (size_t)s->x.n;
    for (int jx = -b->reach[group]; jx <= b->reach[group]; jx++) {
        const size_t wave = (size_t)(jx + p->max_jx) * nx;
        double *re = values + (size_t)(2 * t) * FFT_LANES;
        for (size_t l = 0; l < FFT_LANES; l++) {
            multiply(s->x.re + wave, s->x.im + wave, s->row_re + l * nx, s->row_im + l * nx, nx,
                     re + l, re + FFT_LANES + l);
        }
        values += column_size(b);
    }
}

static void fill_group(const psf_basis *b, const separable *s, const mode_plane *p,
                       const shear_psf_model *m, int group, double *values) {
    const size_t samples = (size_t)m->nx * (size_t)m->ny;
    for (int t = 0; t < m->terms; t++) {
        transform_along_y(s, m, m->samples + (size_t)t * samples, group);
        transform_along_x(b, s, p, group, t, values);
    }
}

/* Copy |W|^2, which the model has on its own modes. */
static void copy_group(const psf_basis *b, const shear_psf_model *m, int group, double *values) {
    for (int jx = -b->reach[group]; jx <= b->reach[group]; jx++) {
        for (int t = 0; t < m->terms; t++) {
            for (int l = 0; l < FFT_LANES; l++) {
                const int y = group * FFT_LANES + l + m->ny / 2;
                const size_t at = ((size_t)t * (size_t)m->ny + (size_t)y) * (size_t)m->nx +
                                  (size_t)(jx + m->nx / 2);
                *values++ = y < m->ny ? m->samples[at] : 0.0;
            }
        }
    }
}

static void fill_flux(psf_basis *b, const shear_psf_model *m) {
    const size_t samples = (size_t)m->nx * (size_t)m->ny;
    const size_t middle = (size_t)(m->ny / 2) * (size_t)m->nx + (size_t)(m->nx / 2);
    for (size_t t = 0; t < (size_t)m->terms; t++) {
        const double *plane = m->samples + t * samples;
        b->flux[t] = b->parts == 1 ? plane[middle] : 0.0;
        for (size_t i = 0; i < samples && b->parts == 2; i++)
            b->flux[t] += plane[i];
    }
}

bool psf_basis_fill(psf_basis *b, const mode_plane *p, const shear_psf_model *m) {
    separable s = {0};
    arena a = {0};
    separable_place(&s, p, m, &a);
    CLEANUP(release_free) void *memory = arena_allocate(&a);
    if (memory == NULL)
        return false;
    separable_place(&s, p, m, &a);
    waves_fill(&s.x, 2.0 * M_PI / p->nx, -p->max_jx, 2 * p->max_jx + 1, m);
    waves_fill(&s.y, 2.0 * M_PI / p->ny, 0, (int)p->stride, m);
    fill_flux(b, m);
    double *values = b->values;
    for (int group = 0; group < b->groups; group++) {
        b->reach[group] = reach_of(p, group);
        if (b->parts == 1) {
            copy_group(b, m, group, values);
        } else {
            fill_group(b, &s, p, m, group, values);
        }
        values += (2 * (size_t)b->reach[group] + 1) * column_size(b);
    }
    return true;
}

/* ---- a galaxy's PSF ---- */

/* Compute the power of `columns` columns of a group, from the sums of their terms. */
SHEAR_SIMD static void combine(const double *values, const double *c, size_t terms, size_t columns,
                               size_t stride, double *power) {
    for (size_t x = 0; x < columns; x++) {
        double re[FFT_LANES] = {0};
        double im[FFT_LANES] = {0};
        for (size_t t = 0; t < terms; t++) {
#pragma omp simd
            for (size_t l = 0; l < FFT_LANES; l++) {
                re[l] += c[t] * values[l];
                im[l] += c[t] * values[FFT_LANES + l];
            }
            values += 2 * FFT_LANES;
        }
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++)
            power[x * stride + l] = re[l] * re[l] + im[l] * im[l];
    }
}

/* The same for |W|^2. */
SHEAR_SIMD static void combine_power(const double *values, const double *c, size_t terms,
                                     size_t columns, size_t stride, double *power) {
    for (size_t x = 0; x < columns; x++) {
        double sum[FFT_LANES] = {0};
        for (size_t t = 0; t < terms; t++) {
#pragma omp simd
            for (size_t l = 0; l < FFT_LANES; l++)
                sum[l] += c[t] * values[l];
            values += FFT_LANES;
        }
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++)
            power[x * stride + l] = sum[l];
    }
}

/* Scale the coefficients so that W(0) = 1. */
static bool normalise(const psf_basis *b, const double *c, double *scaled) {
    double flux = 0.0;
    bool finite = true;
    for (int t = 0; t < b->terms; t++)
        flux += c[t] * b->flux[t];
    for (int t = 0; t < b->terms; t++) {
        scaled[t] = c[t] / flux;
        finite = finite && isfinite(scaled[t]);
    }
    return finite && flux > 0.0;
}

bool psf_basis_power(const psf_basis *b, const mode_plane *p, const target *aim, const double *c,
                     double *power) {
    double scaled[SHEAR_MAX_PSF_TERMS];
    const double *values = b->values;
    if (!normalise(b, c, scaled))
        return false;
    for (int group = 0; group * FFT_LANES <= aim->jy; group++) {
        const int reach = b->reach[group];
        const int wanted = target_last_jx(aim, p, aim->limit, group * FFT_LANES, reach);
        const size_t skipped = (size_t)(reach - wanted) * column_size(b);
        (b->parts == 2 ? combine : combine_power)(
            values + skipped, scaled, (size_t)b->terms, 2 * (size_t)wanted + 1, p->stride,
            power + mode_plane_column(p, -wanted) + (size_t)group * FFT_LANES);
        values += (2 * (size_t)reach + 1) * column_size(b);
    }
    return true;
}
