/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "psf.h"

#include "base/simd.h"
#include "shear_mocks/mock.h"

#include <gsl/gsl_math.h>
#include <gsl/gsl_sf_bessel.h>
#include <math.h>
#include <stddef.h>

/* Constants of eq. (9) of Zhang (2010). */
static const double axis_ratio2 = 0.8;
static const double spike_height = 0.03;
static const double spike_core = 0.2;

/* -ln of the faintest term that is computed: half of 1e-20, because W_B has two terms */
static const double ln_cut = 20 * M_LN10 + M_LN2;

/* Compute cosine and sine, exactly for multiples of 90 degrees. */
static void rotation_of(double angle_deg, double *c, double *s) {
    const double a = remainder(angle_deg, 360.0);
    const double quarter = nearbyint(a / 90.0);
    const double rest = (a - 90.0 * quarter) * (M_PI / 180.0);
    *c = cos(rest);
    *s = sin(rest);
    for (int i = 0; i < ((int)quarter + 4) % 4; i++) {
        const double before = *c;
        *c = -*s;
        *s = before;
    }
}

psf_shape psf_make(enum shear_mock_psf kind, double r_px, double angle_deg) {
    psf_shape p = {.r = r_px, .spikes = kind == SHEAR_MOCK_PSF_B};
    rotation_of(angle_deg, &p.cos, &p.sin);
    double k = 0.5 / (r_px * r_px);
    p.a = k * (p.cos * p.cos + axis_ratio2 * p.sin * p.sin);
    p.b = k * (1.0 - axis_ratio2) * p.cos * p.sin;
    p.c = k * (p.sin * p.sin + axis_ratio2 * p.cos * p.cos);
    return p;
}

double psf_peak(enum shear_mock_psf kind) {
    return kind == SHEAR_MOCK_PSF_B ? 1.0 + spike_height * exp(-spike_core * spike_core) : 1.0;
}

/* The integral of the spikes: the one over u is Gaussian; with v = sqrt(0.2) R sinh t the other is
 * an integral representation of the Bessel function K_0. Result: sqrt(pi) exp(-z) K_0(z) R^2 with z
 * = 0.2^2 / 2. */
double psf_flux(enum shear_mock_psf kind, double r_px) {
    double r2 = r_px * r_px;
    double flux = 2.0 * M_PI * r2 / sqrt(axis_ratio2);
    if (kind == SHEAR_MOCK_PSF_B) {
        double z = 0.5 * spike_core * spike_core;
        flux += spike_height * r2 * sqrt(M_PI) * exp(-z) * gsl_sf_bessel_K0(z);
    }
    return flux;
}

double psf_gaussian_reach(double r_px) {
    return r_px * sqrt(2.0 * ln_cut / axis_ratio2);
}

/* The spikes reach farthest on their axes: (u^2/R^2 + 0.2) 0.2 = ln(0.03 / 1e-20). */
double psf_spikes_reach(double r_px) {
    return r_px * sqrt((ln_cut + log(spike_height)) / spike_core - spike_core);
}

double psf_reach(enum shear_mock_psf kind, double r_px) {
    double gaussian = psf_gaussian_reach(r_px);
    return kind == SHEAR_MOCK_PSF_B ? fmax(gaussian, psf_spikes_reach(r_px)) : gaussian;
}

/* Compute the smallest |u| and |v| within `radius` of (dx, dy), in the PSF's frame. */
static void nearest(const psf_shape *p, double dx, double dy, double radius, double *u, double *v) {
    *u = fmax(0.0, fabs(p->cos * dx + p->sin * dy) - radius);
    *v = fmax(0.0, fabs(p->cos * dy - p->sin * dx) - radius);
}

bool psf_gaussian_reaches(const psf_shape *p, double dx, double dy, double radius) {
    double u, v;
    nearest(p, dx, dy, radius, &u, &v);
    return u * u + axis_ratio2 * v * v <= 2.0 * p->r * p->r * ln_cut;
}

bool psf_spikes_reach_to(const psf_shape *p, double dx, double dy, double radius) {
    double u, v;
    nearest(p, dx, dy, radius, &u, &v);
    u /= p->r;
    v /= p->r;
    return (u * u + spike_core) * (v * v + spike_core) <= ln_cut + log(spike_height);
}

void psf_gaussian_row(const psf_shape *p, double amplitude, double dx, double dy, double step,
                      int n, double *out) {
    const double a = p->a;
    const double b2 = 2.0 * p->b * dy;
    const double c = p->c * dy * dy;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        double x = dx + step * i;
        out[i] = amplitude * exp(-((a * x + b2) * x + c));
    }
}

static double psf_spikes_at(const psf_shape *p, double dx, double dy) {
    double u = (p->cos * dx + p->sin * dy) / p->r;
    double v = (p->cos * dy - p->sin * dx) / p->r;
    return spike_height * exp(-((u * u + spike_core) * (v * v + spike_core)));
}

SHEAR_SIMD void psf_spikes_row(const psf_shape *p, double amplitude, double dx, double dy,
                               double step, int n, double *out) {
    const double k = 1.0 / p->r;
    const double uc = k * p->cos;
    const double vc = -k * p->sin;
    const double u0 = k * p->sin * dy;
    const double v0 = k * p->cos * dy;
    const double scale = spike_height * amplitude;
    const double core = spike_core;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        double x = dx + step * i;
        double u = u0 + uc * x;
        double v = v0 + vc * x;
        double z = (u * u + core) * (v * v + core);
        out[i] = z < 700.0 ? z : 700.0; /* if exp underflows, its vector version becomes slow */
    }
#pragma omp simd simdlen(8)
    for (int i = 0; i < n; i++)
        out[i] = scale * exp(-out[i]);
}

void psf_image(enum shear_mock_psf kind, double r_px, double angle_deg, int oversample, int nx,
               int ny, double *out) {
    psf_shape p = psf_make(kind, r_px, angle_deg);
    double step = 1.0 / oversample;
    double x0 = -0.5 * (nx - 1) * step;
    for (int j = 0; j < ny; j++) {
        double dy = (j - 0.5 * (ny - 1)) * step;
        double *row = out + (size_t)j * (size_t)nx;
        psf_gaussian_row(&p, 1.0, x0, dy, step, nx, row);
        for (int i = 0; p.spikes && i < nx; i++)
            row[i] += psf_spikes_at(&p, x0 + step * i, dy);
    }
}
