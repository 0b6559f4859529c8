/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/transfer.h"

#include "measure/psf.h"

#include <math.h>
#include <string.h>

bool transfer_plan_init(transfer_plan *p) {
    p->k_limit = M_PI * (p->s < p->q ? p->s : p->q);
    /* The largest index of a mode inside the circle: 2 pi j / n < k_limit. */
    const int side = p->s < p->q ? p->s : p->q;
    p->max_jx = (p->nx * side - 1) / 2;
    p->max_jy = (p->ny * side - 1) / 2;
    p->stride = ((size_t)p->max_jx + FFT_COLUMNS) / FFT_COLUMNS * FFT_COLUMNS;
    p->row = fft_line_real_new(p->nx * p->q);
    p->column = fft_line_complex_new(p->ny * p->q);
    return p->row != NULL && p->column != NULL;
}

void transfer_plan_deinit(transfer_plan *p) {
    fft_line_free(p->row);
    fft_line_free(p->column);
    image_grid_deinit(&p->grid);
    *p = (transfer_plan){0};
}

static size_t table_size(const transfer_plan *p) {
    return (2 * (size_t)p->max_jy + 1) * p->stride;
}

bool transfer_scratch_init(transfer_scratch *t, const transfer_plan *p) {
    const size_t width = (size_t)p->nx * (size_t)p->q;
    *t = (transfer_scratch){.column_stride = fft_row_stride(p->ny * p->q)};
    const bool image_made = image_init(&t->image, &p->grid);
    t->fine_row = fft_alloc((size_t)p->grid.fine_nx * sizeof *t->fine_row);
    t->line = fft_alloc(width * sizeof *t->line);
    t->modes = fft_alloc((width / 2 + 1) * sizeof *t->modes);
    t->columns = fft_alloc(((size_t)p->max_jx + 1) * t->column_stride * sizeof *t->columns);
    t->power = fft_alloc(table_size(p) * sizeof *t->power);
    return image_made && t->fine_row != NULL && t->line != NULL && t->modes != NULL &&
           t->columns != NULL && t->power != NULL;
}

void transfer_scratch_deinit(transfer_scratch *t) {
    image_deinit(&t->image);
    fft_free(t->fine_row);
    fft_free(t->line);
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

/* The PSF's rows, folded onto the stamp's period (exact: at the stamp's modes exp(-ikx) has that
 * period), are transformed one by one and gathered by column. The closing cells of the PSF's
 * interpolation are left out: its image is no period, and what lies beyond its last sample on one
 * side only would shift and shear it. */
static void transform_rows(const transfer_plan *p, transfer_scratch *t) {
    const int width = p->nx * p->q;
    const int height = p->ny * p->q;
    const int fine_nx = p->grid.fine_nx - (p->grid.x.s - 1);
    const int fine_ny = p->grid.fine_ny - (p->grid.y.s - 1);
    memset(t->columns, 0, ((size_t)p->max_jx + 1) * t->column_stride * sizeof *t->columns);
    for (int y = 0; y < fine_ny; y++) {
        image_row(&t->image, &p->grid, y, 0, fine_nx, t->fine_row);
        memset(t->line, 0, (size_t)width * sizeof *t->line);
        for (int x = 0; x < fine_nx; x++) {
            t->line[x % width] += t->fine_row[x];
        }
        fft_line_real(p->row, t->line, t->modes);
        for (int jx = 0; jx <= p->max_jx; jx++) {
            t->columns[(size_t)jx * t->column_stride + (size_t)(y % height)] += t->modes[jx];
        }
    }
}

static double squared_modulus(double complex z) {
    return creal(z) * creal(z) + cimag(z) * cimag(z);
}

/* |W|^2 on the modes, W(0) = 1. */
static void power_of_psf(const transfer_plan *p, transfer_scratch *t) {
    const int height = p->ny * p->q;
    transform_rows(p, t);
    for (int jx = 0; jx <= p->max_jx; jx++) {
        fft_line_complex(p->column, t->columns + (size_t)jx * t->column_stride);
    }
    /* The amplitude first, squared after: a PSF's flux is in any unit, and its square may leave the
     * range of double. */
    const double scale = 1.0 / cabs(t->columns[0]);
    for (int jy = -p->max_jy; jy <= p->max_jy; jy++) {
        double *row = t->power + (size_t)(jy + p->max_jy) * p->stride;
        const double complex *column = t->columns + (jy < 0 ? jy + height : jy);
        for (int jx = 0; jx <= p->max_jx; jx++) {
            row[jx] = squared_modulus(scale * column[(size_t)jx * t->column_stride]);
        }
    }
}

/* The isotropic cut: the smallest |k| at which |W|^2 is below the threshold, at most the Nyquist
 * circle. Its square is not above that mode's |k|^2, although the root rounds: else the mode
 * itself, which may hold nothing, would be divided by. */
static double find_cut(const transfer_plan *p, const transfer_scratch *t) {
    const double ux = 2.0 * M_PI / p->nx;
    const double uy = 2.0 * M_PI / p->ny;
    double cut2 = p->k_limit * p->k_limit;
    for (int jy = -p->max_jy; jy <= p->max_jy; jy++) {
        const double *row = t->power + (size_t)(jy + p->max_jy) * p->stride;
        const double ky2 = (uy * jy) * (uy * jy);
        for (int jx = 0; jx <= p->max_jx && ky2 + (ux * jx) * (ux * jx) < cut2; jx++) {
            if (!(row[jx] >= p->threshold)) {
                cut2 = ky2 + (ux * jx) * (ux * jx);
            }
        }
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

/* T from |W|^2: rows [-jy, jy], columns [0, jx] of modes inside the cut. */
static void fill_table(transfer *t, const transfer_plan *p, const transfer_scratch *scratch) {
    const double ux = 2.0 * M_PI / p->nx;
    const double uy = 2.0 * M_PI / p->ny;
    const double cut2 = t->k_cut * t->k_cut;
    const double s2 = (double)p->s * p->s;
    const double norm = 1.0 / ((double)p->nx * p->ny * s2 * s2);
    const double beta2 = p->beta_px * p->beta_px;
    for (int jy = -t->jy; jy <= t->jy; jy++) {
        const size_t row = (size_t)(jy + p->max_jy) * p->stride;
        const double ky2 = (uy * jy) * (uy * jy);
        for (int jx = 0; jx <= t->jx; jx++) {
            const double k2 = ky2 + (ux * jx) * (ux * jx);
            const double both_halves = jx > 0 ? 2.0 : 1.0;
            t->t[row + (size_t)jx] =
                k2 < cut2 ? both_halves * norm * exp(-beta2 * k2) / scratch->power[row + (size_t)jx]
                          : 0.0;
        }
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
