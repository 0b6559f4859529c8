/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/psf_waves.h"

#include "base/simd.h"
#include "measure/lanczos.h"

#include <math.h>

void psf_waves_place(psf_waves *w, const mode_plane *p, int nx, int ny, arena *a) {
    const size_t along_x = (2 * (size_t)p->max_jx + 1) * (size_t)nx;
    const size_t along_y = p->stride * (size_t)ny;
    *w = (psf_waves){.nx = nx,
                     .ny = ny,
                     .x_re = arena_doubles(a, along_x),
                     .x_im = arena_doubles(a, along_x),
                     .y_re = arena_doubles(a, along_y),
                     .y_im = arena_doubles(a, along_y)};
}

/* The order of the kernel that has smoothed samples. */
enum { SMOOTHED = 3 };

/* Return the transform of the kernel between samples over that of the one that has smoothed them,
 * at k radians per pixel. The latter is taken no smaller than at
 * its half power, beyond which no PSF that is sampled so has any. */
static double kernel_at(const shear_psf_model *m, double k) {
    const double between = m->lanczos > 0 ? lanczos_transform(m->lanczos, k * m->step) : 1.0;
    if (!(m->smoothed_px > 0.0))
        return between;
    return between / lanczos_transform(SMOOTHED, fmin(fabs(k) * m->smoothed_px, M_PI));
}

/* Fill one mode's n samples; k: radians per pixel. */
static void fill_mode(const shear_psf_model *m, double k, int n, double *re, double *im) {
    const double kernel = kernel_at(m, k);
    const double phase = k * m->step;
    for (int i = 0; i < n; i++) {
        const double x = phase * (i - 0.5 * (n - 1));
        re[i] = kernel * cos(x);
        im[i] = -kernel * sin(x);
    }
}

void psf_waves_fill(psf_waves *w, const mode_plane *p, const shear_psf_model *m) {
    for (int jx = -p->max_jx; jx <= p->max_jx; jx++) {
        const size_t at = (size_t)(jx + p->max_jx) * (size_t)w->nx;
        fill_mode(m, 2.0 * M_PI / p->nx * jx, w->nx, w->x_re + at, w->x_im + at);
    }
    for (int jy = 0; jy < (int)p->stride; jy++) {
        const size_t at = (size_t)jy * (size_t)w->ny;
        fill_mode(m, 2.0 * M_PI / p->ny * jy, w->ny, w->y_re + at, w->y_im + at);
    }
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

void psf_waves_along_y(const psf_waves *w, const double *samples, int group, double *rows) {
    const size_t nx = (size_t)w->nx;
    for (size_t l = 0; l < FFT_LANES; l++) {
        double *re = rows + 2 * l * nx;
        const size_t row = ((size_t)group * FFT_LANES + l) * (size_t)w->ny;
        for (size_t x = 0; x < 2 * nx; x++)
            re[x] = 0.0;
        for (size_t y = 0; y < (size_t)w->ny; y++)
            add_samples(samples + y * nx, w->y_re[row + y], w->y_im[row + y], nx, re, re + nx);
    }
}

/* Compute the real and the imaginary part of sum_i (a + ib)(c + id). */
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

void psf_waves_along_x(const psf_waves *w, const mode_plane *p, const double *rows, int jx,
                       double *out) {
    const size_t nx = (size_t)w->nx;
    const size_t at = (size_t)(jx + p->max_jx) * nx;
    for (size_t l = 0; l < FFT_LANES; l++) {
        const double *row = rows + 2 * l * nx;
        multiply(w->x_re + at, w->x_im + at, row, row + nx, nx, out + l, out + FFT_LANES + l);
    }
}
