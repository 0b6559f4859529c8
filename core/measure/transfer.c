/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/transfer.h"

#include "base/simd.h"
#include "measure/psf.h"

#include <math.h>
#include <string.h>

/* |W_beta|^2 on the modes, with the factor of both halves and the integrals' over the plane. */
static void fill_target(transfer_plan *p) {
    const double ux = 2.0 * M_PI / p->nx;
    const double uy = 2.0 * M_PI / p->ny;
    const double s2 = (double)p->s * p->s;
    const double norm = 1.0 / ((double)p->nx * p->ny * s2 * s2);
    for (int jx = 0; jx < (int)p->stride; jx++) {
        p->kx2[jx] = jx <= p->max_jx ? (ux * jx) * (ux * jx) : INFINITY;
    }
    for (int jy = -p->max_jy; jy <= p->max_jy; jy++) {
        double *row = p->target + (size_t)(jy + p->max_jy) * p->stride;
        for (int jx = 0; jx < (int)p->stride; jx++) {
            const double k2 = (uy * jy) * (uy * jy) + p->kx2[jx];
            row[jx] = (jx > 0 ? 2.0 : 1.0) * norm * exp(-p->beta_px * p->beta_px * k2);
        }
    }
}

static size_t table_size(const transfer_plan *p) {
    return (2 * (size_t)p->max_jy + 1) * p->stride;
}

static int period_x(const transfer_plan *p) {
    return p->nx * p->q;
}

static int period_y(const transfer_plan *p) {
    return p->ny * p->q;
}

/* Fine points of the PSF along an axis. The closing cells of its interpolation are left out: its
 * image is no period, and what lies beyond its last sample on one side only would shift and shear
 * it. */
static int psf_fine(const axis *ax) {
    return ax->n * ax->s - (ax->s - 1);
}

bool transfer_plan_init(transfer_plan *p) {
    p->k_limit = M_PI * (p->s < p->q ? p->s : p->q);
    /* The largest index of a mode inside the circle: 2 pi j / n < k_limit. */
    const int side = p->s < p->q ? p->s : p->q;
    p->max_jx = (p->nx * side - 1) / 2;
    p->max_jy = (p->ny * side - 1) / 2;
    p->stride = fft_padded(p->max_jx + 1);
    const int fine_ny = psf_fine(&p->grid.y);
    p->used_ny = fine_ny < period_y(p) ? fine_ny : period_y(p);
    p->mode_stride = fft_row_stride(period_x(p) / 2 + FFT_LINES);
    const fft_layout lines = {.step = 1, .apart = period_x(p)};
    const fft_layout modes = {.step = 1, .apart = (int)p->mode_stride};
    const fft_layout across = {.step = (int)p->mode_stride, .apart = 1};
    const fft_layout columns = {.step = FFT_LINES, .apart = 1};
    p->rows = fft_real_new(period_x(p), lines, modes);
    p->columns = fft_complex_new(period_y(p), across, columns);
    p->kx2 = fft_alloc(p->stride * sizeof *p->kx2);
    p->target = fft_alloc(table_size(p) * sizeof *p->target);
    if (p->rows == NULL || p->columns == NULL || p->kx2 == NULL || p->target == NULL) {
        return false;
    }
    fill_target(p);
    return true;
}

void transfer_plan_deinit(transfer_plan *p) {
    fft_batch_free(p->rows);
    fft_batch_free(p->columns);
    fft_free(p->kx2);
    fft_free(p->target);
    image_grid_deinit(&p->grid);
    *p = (transfer_plan){0};
}

bool transfer_scratch_init(transfer_scratch *t, const transfer_plan *p) {
    const size_t modes = fft_padded(period_y(p)) * p->mode_stride;
    *t = (transfer_scratch){0};
    const bool image_made = image_init(&t->image, &p->grid);
    t->fine_row = fft_alloc((size_t)p->grid.fine_nx * sizeof *t->fine_row);
    t->folded = fft_alloc(fft_padded(p->used_ny) * (size_t)period_x(p) * sizeof *t->folded);
    t->modes = fft_alloc(modes * sizeof *t->modes);
    t->columns = fft_alloc((size_t)period_y(p) * FFT_LINES * sizeof *t->columns);
    t->power = fft_alloc(table_size(p) * sizeof *t->power);
    if (t->modes != NULL) {
        memset(t->modes, 0, modes * sizeof *t->modes);
    }
    return image_made && t->fine_row != NULL && t->folded != NULL && t->modes != NULL &&
           t->columns != NULL && t->power != NULL;
}

void transfer_scratch_deinit(transfer_scratch *t) {
    image_deinit(&t->image);
    fft_free(t->fine_row);
    fft_free(t->folded);
    fft_free(t->modes);
    fft_free(t->columns);
    fft_free(t->power);
    *t = (transfer_scratch){0};
}

bool transfer_init(transfer *t, const transfer_plan *p) {
    *t = (transfer){.t = fft_alloc(table_size(p) * sizeof *t->t)};
    return t->t != NULL;
}

void transfer_deinit(transfer *t) {
    fft_free(t->t);
    *t = (transfer){0};
}

/* The PSF folded onto the stamp's period (exact: at the stamp's modes exp(-ikx) has that period).
 */
static void fold_psf(const transfer_plan *p, transfer_scratch *t) {
    const int width = period_x(p);
    const int fine_nx = psf_fine(&p->grid.x);
    const int fine_ny = psf_fine(&p->grid.y);
    memset(t->folded, 0, fft_padded(p->used_ny) * (size_t)width * sizeof *t->folded);
    for (int y = 0; y < fine_ny; y++) {
        double *row = t->folded + (size_t)(y % period_y(p)) * (size_t)width;
        image_row(&t->image, &p->grid, y, 0, fine_nx, t->fine_row);
        for (int from = 0; from < fine_nx; from += width) {
            const int n = fine_nx - from < width ? fine_nx - from : width;
            for (int x = 0; x < n; x++) {
                row[x] += t->fine_row[from + x];
            }
        }
    }
}

/* |scale W|^2 of one group of columns; scale W(0) = 1. The amplitude first, squared after: a PSF's
 * flux is in any unit, and its square may leave the range of double. */
SHEAR_SIMD static void square_columns(const double *columns, int ny, int max_jy, size_t stride,
                                      double scale, double *power) {
    for (int jy = -max_jy; jy <= max_jy; jy++) {
        const double *modes = columns + 2 * FFT_LINES * (ptrdiff_t)(jy < 0 ? jy + ny : jy);
        double *row = power + (size_t)(jy + max_jy) * stride;
#pragma omp simd
        for (int l = 0; l < FFT_LINES; l++) {
            const double re = scale * modes[2 * l];
            const double im = scale * modes[2 * l + 1];
            row[l] = re * re + im * im;
        }
    }
}

/* |W|^2 on the modes, W(0) = 1. */
static void power_of_psf(const transfer_plan *p, transfer_scratch *t) {
    double scale = 0.0;
    fold_psf(p, t);
    for (int y = 0; y < p->used_ny; y += FFT_LINES) {
        fft_real(p->rows, t->folded + (size_t)y * (size_t)period_x(p),
                 t->modes + (size_t)y * p->mode_stride);
    }
    for (int jx = 0; jx <= p->max_jx; jx += FFT_LINES) {
        fft_complex(p->columns, t->modes + jx, t->columns);
        scale = jx == 0 ? 1.0 / cabs(t->columns[0]) : scale;
        square_columns((const double *)t->columns, period_y(p), p->max_jy, p->stride, scale,
                       t->power + jx);
    }
}

/* The smallest kx^2 of a row at which |W|^2 is below the threshold, or not a number. */
SHEAR_SIMD static double lowest_below(const double *power, const double *kx2, size_t n,
                                      double threshold) {
    double lowest = INFINITY;
#pragma omp simd reduction(min : lowest)
    for (size_t jx = 0; jx < n; jx++) {
        const double k2 = power[jx] >= threshold ? INFINITY : kx2[jx];
        lowest = k2 < lowest ? k2 : lowest;
    }
    return lowest;
}

/* The isotropic cut: the smallest |k| at which |W|^2 is below the threshold, at most the Nyquist
 * circle. Its square is not above that mode's |k|^2, although the root rounds: else the mode
 * itself, which may hold nothing, would be divided by. */
static double find_cut(const transfer_plan *p, const transfer_scratch *t) {
    const double uy = 2.0 * M_PI / p->ny;
    double cut2 = p->k_limit * p->k_limit;
    for (int jy = -p->max_jy; jy <= p->max_jy; jy++) {
        const double *row = t->power + (size_t)(jy + p->max_jy) * p->stride;
        const double low2 = lowest_below(row, p->kx2, p->stride, p->threshold);
        const double k2 = (uy * jy) * (uy * jy) + low2;
        cut2 = k2 < cut2 ? k2 : cut2;
    }
    double cut = sqrt(cut2);
    while (cut * cut > cut2) {
        cut = nextafter(cut, 0.0);
    }
    return cut;
}

double transfer_power_beyond(double beta_px, double k_cut) {
    const double x = (beta_px * k_cut) * (beta_px * k_cut);
    return (1.0 + x + 0.5 * x * x) * exp(-x);
}

/* Rounded up to what a message prints, so that the printed number works. */
double transfer_smallest_beta(double k_cut, double tolerance) {
    double low = 0.0;
    double high = 1.0;
    while (transfer_power_beyond(high, k_cut) > tolerance) {
        high *= 2.0;
        if (!isfinite(high)) {
            return INFINITY;
        }
    }
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        *(transfer_power_beyond(middle, k_cut) > tolerance ? &low : &high) = middle;
    }
    return ceil(1e4 * high) / 1e4;
}

SHEAR_SIMD static void fill_row(const double *target, const double *power, const double *kx2,
                                double ky2, double cut2, size_t n, double *t) {
#pragma omp simd
    for (size_t jx = 0; jx < n; jx++) {
        t[jx] = ky2 + kx2[jx] < cut2 ? target[jx] / power[jx] : 0.0;
    }
}

/* T from |W|^2: rows [-jy, jy], whole groups of columns up to jx. */
static void fill_table(transfer *t, const transfer_plan *p, const transfer_scratch *scratch) {
    const double uy = 2.0 * M_PI / p->ny;
    for (int jy = -t->jy; jy <= t->jy; jy++) {
        const size_t row = (size_t)(jy + p->max_jy) * p->stride;
        fill_row(p->target + row, scratch->power + row, p->kx2, (uy * jy) * (uy * jy),
                 t->k_cut * t->k_cut, fft_padded(t->jx + 1), t->t + row);
    }
}

static int last_mode(double k_cut, int n, int max_j) {
    const int j = (int)floor(k_cut * n / (2.0 * M_PI));
    return j < max_j ? j : max_j;
}

int transfer_make(transfer *t, const transfer_plan *p, transfer_scratch *scratch, const double *psf,
                  shear_error *err) {
    int bad_x;
    int bad_y;
    const int checked = psf_check(psf, p->psf_nx, p->psf_ny, err);
    if (checked != SHEAR_OK) {
        return checked;
    }
    if (!image_load(&scratch->image, &p->grid, psf, &bad_x, &bad_y)) {
        return shear_fail(
            err, SHEAR_E_NEGATIVE,
            "give a PSF without negative samples, or sampled finer (OVERSAMP), or an interpolation "
            "that is not logarithmic",
            "the PSF is negative at sample (%d, %d), and a log method interpolates it", bad_x + 1,
            bad_y + 1);
    }
    power_of_psf(p, scratch);
    t->k_cut = find_cut(p, scratch);
    if (transfer_power_beyond(p->beta_px, t->k_cut) > p->power_tolerance) {
        const double smallest = transfer_smallest_beta(t->k_cut, p->power_tolerance);
        return shear_fail(
            err, SHEAR_E_BETA, "use a larger beta (or beta-ratio)",
            "beta = %.4g px is too small: the PSF holds information only up to k = %.4g "
            "rad/px; the smallest beta that works is %.4f px",
            p->beta_px, t->k_cut, smallest);
    }
    t->jx = last_mode(t->k_cut, p->nx, p->max_jx);
    t->jy = last_mode(t->k_cut, p->ny, p->max_jy);
    fill_table(t, p, scratch);
    return SHEAR_OK;
}
