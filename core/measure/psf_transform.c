/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The image is interpolated, aliased onto the stamp's period, and transformed, two strips of
 * columns at a time. */
#include "measure/psf_transform.h"

#include "base/cleanup.h"
#include "base/simd.h"
#include "shear/psf.h"

#include <math.h>
#include <string.h>

/* Columns that are transformed along y together: two strips, one as real and one as imaginary
 * part. */
enum { PAIR = 2 * FFT_LANES };

/* Return the fine points of the PSF along an axis, without the closing cells of its interpolation:
 * its image is not periodic, and what lies beyond its last sample, on one side only, would shift
 * and shear it. */
static int psf_fine(const axis *ax) {
    return ax->n * ax->s - (ax->s - 1);
}

void psf_transform_set_sizes(psf_transform *p) {
    p->period_nx = p->plane.nx * p->q;
    p->period_ny = p->plane.ny * p->q;
    p->psf_fine_nx = psf_fine(&p->grid.x);
    p->psf_fine_ny = psf_fine(&p->grid.y);
    p->used_nx = p->psf_fine_nx < p->period_nx ? p->psf_fine_nx : p->period_nx;
    p->used_ny = p->psf_fine_ny < p->period_ny ? p->psf_fine_ny : p->period_ny;
}

void psf_scratch_place(psf_scratch *t, const psf_transform *p, arena *a) {
    const int longest = p->period_nx > p->period_ny ? p->period_nx : p->period_ny;
    *t = (psf_scratch){.aliased_stride = ((size_t)p->period_nx + PAIR - 1) / PAIR * PAIR};
    surface_place(&t->image, &p->grid, a);
    t->strip = arena_doubles(a, (size_t)p->grid.fine_ny * FFT_LANES);
    t->aliased = arena_doubles(a, (size_t)p->period_ny * t->aliased_stride);
    for (int i = 0; i < 2; i++)
        t->lanes[i] = fft_lanes_take(a, longest + 1);
    t->modes = arena_doubles(a, 2 * p->plane.stride * t->aliased_stride);
}

/* Alias the PSF onto the stamp's period. This is exact: at the stamp's modes exp(-ikx) has that
 * period. */
static void alias_psf(const psf_transform *p, psf_scratch *t) {
    if (p->grid.x.kind == AXIS_NONE && p->psf_nx <= p->period_nx && p->psf_ny <= p->period_ny) {
        const size_t nx = (size_t)p->psf_nx;
        for (size_t y = 0; y < (size_t)p->psf_ny; y++) {
            memcpy(t->aliased + y * t->aliased_stride, t->image.pixels + y * nx,
                   nx * sizeof *t->aliased);
        }
        return;
    }
    const int width = p->period_nx;
    const int fine_nx = p->psf_fine_nx;
    const int fine_ny = p->psf_fine_ny;
    memset(t->aliased, 0, (size_t)p->used_ny * t->aliased_stride * sizeof *t->aliased);
    for (int x0 = 0; x0 < fine_nx; x0 += FFT_LANES) {
        const int n = fine_nx - x0 < FFT_LANES ? fine_nx - x0 : FFT_LANES;
        surface_strip(&t->image, &p->grid, x0, 0, fine_ny, t->strip);
        for (int y = 0; y < fine_ny; y++) {
            double *row = t->aliased + (size_t)(y % p->period_ny) * t->aliased_stride;
            const double *from = t->strip + (size_t)y * FFT_LANES;
            for (int l = 0; l < n; l++)
                row[(x0 + l) % width] += from[l];
        }
    }
}

/* Separate rows jy of one group of two strips a + i b that were transformed as one. The results are
 * twice their modes,
 *
 *     A(k) = (Z(k) + Z*(-k)) / 2,    B(k) = (Z(k) - Z*(-k)) / 2i.
 *
 * z begins at row jy, mirrored at row -jy, whose rows run backwards. */
SHEAR_SIMD static void part_strips(const double *zr, const double *zi, const double *mr,
                                   const double *mi, double parts[4][FFT_LANES * FFT_LANES]) {
    for (ptrdiff_t r = 0; r < FFT_LANES; r++) {
#pragma omp simd
        for (ptrdiff_t l = 0; l < FFT_LANES; l++) {
            const ptrdiff_t up = FFT_LANES * r + l;
            const ptrdiff_t down = l - FFT_LANES * r;
            parts[0][up] = zr[up] + mr[down];
            parts[1][up] = zi[up] - mi[down];
            parts[2][up] = zi[up] + mi[down];
            parts[3][up] = mr[down] - zr[up];
        }
    }
}

static double *group_modes(const psf_scratch *t, size_t group, size_t part) {
    return t->modes + (2 * group + part) * t->aliased_stride * FFT_LANES;
}

/* Transform two strips of the aliased PSF along y, from column x0 on. */
static void transform_pair(const psf_transform *p, const psf_scratch *t, size_t x0) {
    const double *from = t->aliased + x0;
    double parts[4][FFT_LANES * FFT_LANES];
    const fft_lanes z =
        fft_run(p->along_y, from, from + FFT_LANES, t->aliased_stride, t->lanes[0], t->lanes[1]);
    fft_lanes_close(z, p->period_ny);
    for (size_t group = 0; group < p->plane.stride / FFT_LANES; group++) {
        const size_t up = group * FFT_LANES * FFT_LANES;
        const size_t down = (size_t)p->period_ny * FFT_LANES - up;
        part_strips(z.re + up, z.im + up, z.re + down, z.im + down, parts);
        for (size_t i = 0; i < 4; i++) {
            const size_t strip = x0 + i / 2 * FFT_LANES;
            fft_transpose(parts[i], FFT_LANES, group_modes(t, group, i % 2) + strip * FFT_LANES);
        }
    }
}

/* Compute |scale W|^2 of one group of rows; scale W(0) = 1. The amplitude is scaled before it is
 * squared: a PSF's flux may have any unit, and its square may overflow. */
SHEAR_SIMD static void square_rows(fft_lanes modes, int nx, int max_jx, size_t stride, double scale,
                                   double *power) {
    for (int jx = -max_jx; jx <= max_jx; jx++) {
        const size_t at = (size_t)(jx < 0 ? jx + nx : jx) * FFT_LANES;
        double *column = power + (size_t)(jx + max_jx) * stride;
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++) {
            const double re = scale * modes.re[at + l];
            const double im = scale * modes.im[at + l];
            column[l] = re * re + im * im;
        }
    }
}

static void find_power(const psf_transform *p, psf_scratch *t, double *power) {
    const mode_plane *m = &p->plane;
    double scale = 0.0;
    alias_psf(p, t);
    for (size_t x0 = 0; x0 < (size_t)p->used_nx; x0 += PAIR)
        transform_pair(p, t, x0);
    for (size_t group = 0; group < m->stride / FFT_LANES; group++) {
        const fft_lanes w = fft_run(p->along_x, group_modes(t, group, 0), group_modes(t, group, 1),
                                    FFT_LANES, t->lanes[0], t->lanes[1]);
        scale = group == 0 ? 1.0 / hypot(w.re[0], w.im[0]) : scale;
        square_rows(w, p->period_nx, m->max_jx, m->stride, scale, power + group * FFT_LANES);
    }
}

int psf_transform_power(const psf_transform *p, psf_scratch *scratch, const double *psf,
                        double *power, shear_error *err) {
    int bad_x;
    int bad_y;
    TRY(shear_psf_usable(psf, p->psf_nx, p->psf_ny, err));
    if (!surface_load(&scratch->image, &p->grid, psf, &bad_x, &bad_y)) {
        return shear_fail(
            err, SHEAR_E_NEGATIVE,
            "give a PSF without negative samples, or sampled finer (OVERSAMP), or an interpolation "
            "that is not logarithmic",
            "the PSF is negative at sample (%d, %d), and a log method interpolates it", bad_x + 1,
            bad_y + 1);
    }
    find_power(p, scratch, power);
    return SHEAR_OK;
}
