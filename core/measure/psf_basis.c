/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/psf_basis.h"

#include "base/simd.h"
#include "shear/psf.h"

size_t psf_basis_column_size(const psf_basis *b) {
    return (size_t)b->terms * (size_t)b->parts * FFT_LANES;
}

static int reach_of(const mode_plane *p, int group) {
    const double ky = 2.0 * M_PI / p->ny * group * FFT_LANES;
    const double left = p->k_limit * p->k_limit - ky * ky;
    const int jx = left > 0.0 ? (int)(sqrt(left) * p->nx / (2.0 * M_PI)) : 0;
    return jx < p->max_jx ? jx : p->max_jx;
}

const double *psf_basis_column(const psf_basis *b, int group) {
    return b->values + b->middle[group];
}

void psf_basis_place(psf_basis *b, const mode_plane *p, int terms, int parts, arena *a) {
    *b = (psf_basis){.terms = terms, .parts = parts, .groups = (int)(p->stride / FFT_LANES)};
    const size_t groups = (size_t)b->groups;
    size_t columns = 0;
    b->reach = arena_take(a, groups * sizeof *b->reach);
    b->middle = arena_take(a, groups * sizeof *b->middle);
    for (int group = 0; group < b->groups; group++) {
        const int reach = reach_of(p, group);
        if (a->memory != NULL) {
            b->reach[group] = reach;
            b->middle[group] = (columns + (size_t)reach) * psf_basis_column_size(b);
        }
        columns += 2 * (size_t)reach + 1;
    }
    b->flux = arena_doubles(a, (size_t)terms);
    b->values = arena_doubles(a, columns * psf_basis_column_size(b));
}

static double sum_of(const double *samples, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += samples[i];
    return sum;
}

void psf_basis_fill(psf_basis *b, const mode_plane *p, const psf_waves *w, const double *samples,
                    double *rows) {
    const size_t size = (size_t)w->nx * (size_t)w->ny;
    double *values = b->values;
    for (int group = 0; group < b->groups; group++) {
        for (int t = 0; t < b->terms; t++) {
            double *column = values + (size_t)(2 * t) * FFT_LANES;
            psf_waves_along_y(w, samples + (size_t)t * size, group, rows);
            for (int jx = -b->reach[group]; jx <= b->reach[group]; jx++) {
                psf_waves_along_x(w, p, rows, jx, column);
                column += psf_basis_column_size(b);
            }
        }
        values += (2 * (size_t)b->reach[group] + 1) * psf_basis_column_size(b);
    }
    for (int t = 0; t < b->terms; t++)
        b->flux[t] = sum_of(samples + (size_t)t * size, size);
}

void psf_basis_fill_power(psf_basis *b, const mode_plane *p, const double *power) {
    const size_t nx = (size_t)p->nx;
    const size_t size = nx * (size_t)p->ny;
    const size_t middle = (size_t)(p->ny / 2) * nx + (size_t)(p->nx / 2);
    double *values = b->values;
    for (int group = 0; group < b->groups; group++) {
        for (int jx = -b->reach[group]; jx <= b->reach[group]; jx++) {
            for (size_t t = 0; t < (size_t)b->terms; t++) {
                const double *row = power + t * size + (ptrdiff_t)middle + jx;
                for (int l = 0; l < FFT_LANES; l++) {
                    const int jy = group * FFT_LANES + l;
                    *values++ = jy <= p->max_jy ? row[(size_t)jy * nx] : 0.0;
                }
            }
        }
    }
    for (size_t t = 0; t < (size_t)b->terms; t++)
        b->flux[t] = power[t * size + middle];
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

bool psf_basis_scale(const psf_basis *b, const double *c, double *scaled) {
    double flux = 0.0;
    bool finite = true;
    for (int t = 0; t < b->terms; t++)
        flux += c[t] * b->flux[t];
    for (int t = 0; t < b->terms; t++) {
        scaled[t] = c[t] / flux;
        finite = finite && isfinite(scaled[t]);
    }
    return finite && flux > 0.0 && isnormal(1.0 / flux);
}

bool psf_basis_power(const psf_basis *b, const mode_plane *p, const target_aim *aim,
                     const double *c, double *power) {
    double scaled[SHEAR_MAX_PSF_TERMS];
    if (!psf_basis_scale(b, c, scaled))
        return false;
    for (int group = 0; group * FFT_LANES <= aim->jy; group++) {
        const int last = target_last_jx(aim, p, aim->limit, group * FFT_LANES, b->reach[group]);
        (b->parts == 2 ? combine : combine_power)(
            psf_basis_column(b, group) - (ptrdiff_t)psf_basis_column_size(b) * last, scaled,
            (size_t)b->terms, 2 * (size_t)last + 1, p->stride,
            power + mode_plane_column(p, -last) + (size_t)group * FFT_LANES);
    }
    return true;
}
