/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/psf_sky.h"

#include "base/simd.h"
#include "measure/lanczos.h"
#include "measure/psf_model.h"

#include <math.h>

/* Two columns of a group of rows at once: with one, sums would wait for the one before. */
enum { WIDE = 2 * FFT_LANES };

/* Radians per sample up to which the kernel's transform is approximated; it is 0 beyond. */
static const double kernel_end = 2.0 * M_PI;

/* The four sums of samples at (+-x, +-y): even in both, odd in x, odd in y, odd in both. */
enum parity { EVEN, ODD_X, ODD_Y, ODD };

static int kernel_size(const shear_psf_model *m) {
    return m->lanczos > 0 ? 16 + 4 * m->lanczos : 0;
}

void psf_sky_place(psf_sky *s, const shear_psf_model *m, arena *a) {
    *s = (psf_sky){.model = m, .n_kernel = kernel_size(m)};
    s->flux = arena_doubles(a, (size_t)m->terms);
    s->kernel = arena_doubles(a, (size_t)s->n_kernel);
}

/* Expand the kernel's transform in Chebyshev polynomials of 2 (w / kernel_end)^2 - 1. */
static void fill_kernel(psf_sky *s, int lanczos) {
    const int n = s->n_kernel;
    for (int i = 0; i < n; i++) {
        const double angle = M_PI * (i + 0.5) / n;
        const double w = kernel_end * sqrt(0.5 * (1.0 + cos(angle)));
        const double value = lanczos_transform(lanczos, w) * 2.0 / n;
        for (int j = 0; j < n; j++)
            s->kernel[j] += (j == 0 ? 0.5 : 1.0) * value * cos(j * angle);
    }
}

void psf_sky_fill(psf_sky *s, const shear_psf_model *m) {
    const size_t size = (size_t)m->nx * (size_t)m->ny;
    for (size_t t = 0; t < (size_t)m->terms; t++) {
        for (size_t i = 0; i < size; i++)
            s->flux[t] += m->samples[t * size + i];
    }
    fill_kernel(s, m->lanczos);
}

static int half(int n) {
    return (n + 1) / 2;
}

void psf_sky_scratch_place(psf_sky_scratch *s, int nx, int ny, arena *a) {
    const size_t halves = (size_t)half(nx) * (size_t)half(ny);
    s->image = arena_doubles(a, (size_t)nx * (size_t)ny);
    for (int i = 0; i < 4; i++)
        s->parity[i] = arena_doubles(a, halves);
    s->x = arena_doubles(a, 2 * (size_t)half(nx) * WIDE);
    s->y = arena_doubles(a, 2 * (size_t)half(ny) * WIDE);
}

/* Split the image into its parts of even and odd parity about its middle: element (x, y) is x or x
 * + 1/2 samples from it. On an axis of an odd number of samples the middle one is its own mirror
 * image. */
static void split_parities(const psf_sky_scratch *s, int nx, int ny, double scale) {
    const size_t width = (size_t)half(nx);
    for (int y = 0; y < half(ny); y++) {
        const double *up = s->image + (size_t)(ny / 2 + y) * (size_t)nx;
        const double *down = s->image + (size_t)((ny - 1) / 2 - y) * (size_t)nx;
        for (int x = 0; x < half(nx); x++) {
            const int right = nx / 2 + x;
            const int left = (nx - 1) / 2 - x;
            const double share = scale * (right == left ? 0.5 : 1.0) * (up == down ? 0.5 : 1.0);
            const size_t at = (size_t)y * width + (size_t)x;
            s->parity[EVEN][at] = share * (up[right] + up[left] + down[right] + down[left]);
            s->parity[ODD_X][at] = share * (up[right] - up[left] + down[right] - down[left]);
            s->parity[ODD_Y][at] = share * (up[right] + up[left] - down[right] - down[left]);
            s->parity[ODD][at] = share * (up[right] - up[left] - down[right] + down[left]);
        }
    }
}

/* Phases of two columns. */
typedef struct phases {
    double cosine[WIDE], sine[WIDE];
} phases;

static phases phases_of(const double *angle) {
    phases p;
    for (int l = 0; l < WIDE; l++) {
        p.cosine[l] = cos(angle[l]);
        p.sine[l] = sin(angle[l]);
    }
    return p;
}

static SHEAR_INLINE void turn(phases *p, const double *cosine, const double *sine) {
#pragma omp simd
    for (size_t l = 0; l < WIDE; l++) {
        const double re = p->cosine[l] * cosine[l] - p->sine[l] * sine[l];
        p->sine[l] = p->sine[l] * cosine[l] + p->cosine[l] * sine[l];
        p->cosine[l] = re;
    }
}

/* Fill cosines and sines of n distances: 0, 1, ... (odd sides), or 1/2, 3/2, ...; `by_half`: the
 * phases of half a sample. */
SHEAR_SIMD static void fill_waves(const phases *by_half, bool odd, size_t n, double *waves) {
    phases by_one = *by_half;
    phases now = *by_half;
    turn(&by_one, by_half->cosine, by_half->sine);
    for (size_t l = 0; l < WIDE && odd; l++) {
        now.cosine[l] = 1.0;
        now.sine[l] = 0.0;
    }
    for (size_t i = 0; i < n; i++) {
#pragma omp simd
        for (size_t l = 0; l < WIDE; l++) {
            waves[2 * i * WIDE + l] = now.cosine[l];
            waves[(2 * i + 1) * WIDE + l] = now.sine[l];
        }
        turn(&now, by_one.cosine, by_one.sine);
    }
}

/* A model's transform at the modes of two columns. */
typedef struct lane_sums {
    double re[WIDE], im[WIDE];
} lane_sums;

/* W = sum p exp(-i (a + b)) with phases a along x and b along y:
 *     Re W = sum EVEN cos a cos b - ODD sin a sin b,
 *     -Im W = sum ODD_X sin a cos b + ODD_Y cos a sin b. */
SHEAR_SIMD static void transform(const psf_sky_scratch *s, size_t nx, size_t ny, lane_sums *out) {
    lane_sums sum = {{0}, {0}};
    for (size_t y = 0; y < ny; y++) {
        double even[WIDE] = {0};
        double odd_x[WIDE] = {0};
        double odd_y[WIDE] = {0};
        double odd[WIDE] = {0};
        for (size_t x = 0; x < nx; x++) {
            const double *cosine = s->x + 2 * x * WIDE;
            const double *sine = cosine + WIDE;
            const double p[4] = {s->parity[EVEN][y * nx + x], s->parity[ODD_X][y * nx + x],
                                 s->parity[ODD_Y][y * nx + x], s->parity[ODD][y * nx + x]};
#pragma omp simd
            for (size_t l = 0; l < WIDE; l++) {
                even[l] += p[EVEN] * cosine[l];
                odd_x[l] += p[ODD_X] * sine[l];
                odd_y[l] += p[ODD_Y] * cosine[l];
                odd[l] += p[ODD] * sine[l];
            }
        }
        const double *cosine = s->y + 2 * y * WIDE;
        const double *sine = cosine + WIDE;
#pragma omp simd
        for (size_t l = 0; l < WIDE; l++) {
            sum.re[l] += even[l] * cosine[l] - odd[l] * sine[l];
            sum.im[l] += odd_x[l] * cosine[l] + odd_y[l] * sine[l];
        }
    }
    *out = sum;
}

/* Multiply by the kernel's transform at w radians per sample. */
SHEAR_SIMD static void multiply_kernel(const double *kernel, int n, const double *w,
                                       lane_sums *sums) {
    double x[WIDE];
    double last[WIDE] = {0};
    double before[WIDE] = {0};
#pragma omp simd
    for (size_t l = 0; l < WIDE; l++) {
        const double part = fabs(w[l]) < kernel_end ? w[l] / kernel_end : 1.0;
        x[l] = 2.0 * part * part - 1.0;
    }
    for (int j = n - 1; j > 0; j--) {
#pragma omp simd
        for (size_t l = 0; l < WIDE; l++) {
            const double next = kernel[j] + 2.0 * x[l] * last[l] - before[l];
            before[l] = last[l];
            last[l] = next;
        }
    }
#pragma omp simd
    for (size_t l = 0; l < WIDE; l++) {
        const double value = kernel[0] + x[l] * last[l] - before[l];
        sums->re[l] *= value;
        sums->im[l] *= value;
    }
}

/* Radians per sample along one axis of the sky: by_x kx + by_y ky. */
typedef struct slope {
    double by_x, by_y; /* per jx, jy */
} slope;

static void angles(const slope *s, int jx, int first_jy, double factor, double *out) {
    for (int l = 0; l < WIDE; l++)
        out[l] = factor * (s->by_x * (jx + l / FFT_LANES) + s->by_y * (first_jy + l % FFT_LANES));
}

/* The phases of half a sample along one axis, at the modes of columns jx and jx + 1, and by how
 * much they turn from two columns to the next. */
typedef struct turning {
    phases now, step;
} turning;

static turning turning_from(const slope *s, int jx, int first_jy) {
    double angle[WIDE];
    double step[WIDE];
    angles(s, jx, first_jy, 0.5, angle);
    for (int l = 0; l < WIDE; l++)
        step[l] = s->by_x; /* two columns */
    return (turning){.now = phases_of(angle), .step = phases_of(step)};
}

/* Fill columns [-last, last] of one group of rows. */
static void fill_group(const psf_sky *s, const psf_sky_scratch *scratch, const mode_plane *p,
                       const slope *u, const slope *v, int group, int last, double *power) {
    const shear_psf_model *m = s->model;
    const int first = group * FFT_LANES;
    turning along_u = turning_from(u, -last, first);
    turning along_v = turning_from(v, -last, first);
    for (int jx = -last; jx <= last; jx += 2) {
        double w[WIDE];
        lane_sums sums;
        fill_waves(&along_u.now, m->nx % 2 != 0, (size_t)half(m->nx), scratch->x);
        fill_waves(&along_v.now, m->ny % 2 != 0, (size_t)half(m->ny), scratch->y);
        transform(scratch, (size_t)half(m->nx), (size_t)half(m->ny), &sums);
        if (s->n_kernel > 0) {
            angles(u, jx, first, 1.0, w);
            multiply_kernel(s->kernel, s->n_kernel, w, &sums);
            angles(v, jx, first, 1.0, w);
            multiply_kernel(s->kernel, s->n_kernel, w, &sums);
        }
        for (int l = 0; l < WIDE && jx + l / FFT_LANES <= last; l++) {
            power[mode_plane_column(p, jx + l / FFT_LANES) + (size_t)(first + l % FFT_LANES)] =
                sums.re[l] * sums.re[l] + sums.im[l] * sums.im[l];
        }
        turn(&along_u.now, along_u.step.cosine, along_u.step.sine);
        turn(&along_v.now, along_v.step.cosine, along_v.step.sine);
    }
}

bool psf_sky_power(const psf_sky *s, psf_sky_scratch *scratch, const mode_plane *p,
                   const target_aim *aim, const double *jacobian, const double *c, double *power) {
    const shear_psf_model *m = s->model;
    const double ux = 2.0 * M_PI / p->nx;
    const double uy = 2.0 * M_PI / p->ny;
    frame_map map;
    double flux = 0.0;
    for (int t = 0; t < m->terms; t++)
        flux += c[t] * s->flux[t];
    if (!(flux > 0.0) || !isnormal(1.0 / flux) ||
        !frame_map_make(&map, jacobian, SHEAR_FRAME_SKY)) {
        return false;
    }
    const slope u = {m->step * map.a[0] * ux, m->step * map.a[1] * uy};
    const slope v = {m->step * map.a[2] * ux, m->step * map.a[3] * uy};
    psf_model_sum(m->samples, m->terms, (size_t)m->nx * (size_t)m->ny, c, scratch->image);
    split_parities(scratch, m->nx, m->ny, 1.0 / flux);
    for (int group = 0; group * FFT_LANES <= aim->jy; group++) {
        const int last = target_last_jx(aim, p, aim->limit, group * FFT_LANES, aim->jx);
        fill_group(s, scratch, p, &u, &v, group, last, power);
    }
    return true;
}
