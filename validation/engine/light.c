/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/light.h"

#include <assert.h>
#include <gsl/gsl_fft_complex.h>
#include <gsl/gsl_fft_halfcomplex.h>
#include <gsl/gsl_sf_bessel.h>
#include <gsl/gsl_sf_gamma.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double moffat_index = 3.5;
/* The spikes' light, and their length and width relative to the core's sigma; the angle of the
 * first. */
static const double spike_part = 0.06, spike_length = 6.0, spike_breadth = 0.8, spike_angle = 0.35;
static const double bulge_power = -0.4; /* -1 - nu */

struct light {
    int side, period; /* px */
    int reach;        /* rows of modes: reach * period */
    int columns;      /* modes 0 .. period / 2 of the aliased image */
    double *psf;      /* [reach period][reach][columns] transform of PSF and pixel */
    double *kx;       /* [reach][columns] */
    double *phase;    /* [reach][columns][2] */
    double *modes;    /* [period][columns][2] */
    double *line;     /* [2 period] */
    double *power;    /* [columns] */
    double data[];    /* storage of all these */
};

/* ---- PSFs ---- */

static double moffat(double k, double fwhm) {
    double rd = 0.5 * fwhm / sqrt(pow(2.0, 1.0 / moffat_index) - 1.0);
    double x = k * rd;
    double nu = moffat_index - 1.0;
    if (x < 1e-6)
        return 1.0;
    if (x > 600.0)
        return 0.0;
    return 2.0 / gsl_sf_gamma(nu) * pow(0.5 * x, nu) * gsl_sf_bessel_Knu(nu, x);
}

static double struts(double kx, double ky, double sigma) {
    const double c = cos(spike_angle);
    double s = sin(spike_angle);
    double u = sigma * (c * kx + s * ky);
    double v = sigma * (c * ky - s * kx);
    double l = spike_length * spike_length;
    double b = spike_breadth * spike_breadth;
    double core = exp(-0.5 * (u * u + v * v));
    double spikes = exp(-0.5 * (l * u * u + b * v * v)) + exp(-0.5 * (b * u * u + l * v * v));
    return (1.0 - spike_part) * core + 0.5 * spike_part * spikes;
}

static double sinc(double x) {
    return fabs(x) < 1e-9 ? 1.0 : sin(x) / x;
}

/* The transform of an image sheared by A is the transform of the round image at A^T k. */
static double psf_at(const light_psf *p, double kx, double ky, double scale) {
    double det = sqrt(1.0 - p->e[0] * p->e[0] - p->e[1] * p->e[1]);
    double u = ((1.0 + p->e[0]) * kx + p->e[1] * ky) / det;
    double v = (p->e[1] * kx + (1.0 - p->e[0]) * ky) / det;
    double w = p->kind == LIGHT_MOFFAT ? moffat(hypot(u, v), scale * p->size)
                                       : struts(u, v, scale * p->size);
    return w * sinc(0.5 * scale * kx) * sinc(0.5 * scale * ky);
}

/* ---- modes ---- */

/* Return ky of row r of reach * period rows. */
static double row_k(const light *l, int r) {
    return 2.0 * M_PI * (r - l->reach * l->period / 2) / l->period;
}

static int row_mode(const light *l, int r) {
    int m = (r - l->reach * l->period / 2) % l->period;
    return m < 0 ? m + l->period : m;
}

/* Compute kx of aliases -reach/2 .. reach/2 - 1 of modes 0 .. period/2. With those at -k these are
 * all modes. */
static void fill_columns(light *l) {
    for (int a = 0; a < l->reach; a++) {
        for (int m = 0; m < l->columns; m++) {
            l->kx[a * l->columns + m] =
                2.0 * M_PI * ((double)m / l->period + (double)(a - l->reach / 2));
        }
    }
}

static void fill_psf(light *l, const light_psf *psf, double scale) {
    int n = l->reach * l->columns;
    for (int r = 0; r < l->reach * l->period; r++) {
        for (int m = 0; m < n; m++)
            l->psf[(size_t)r * (size_t)n + (size_t)m] = psf_at(psf, l->kx[m], row_k(l, r), scale);
    }
}

int light_new(light **out, const light_psf *psf, int side, int reach, double scale,
              shear_error *err) {
    const size_t period = 2 * (size_t)side;
    const size_t columns = (size_t)side + 1;
    const size_t n = (size_t)reach * columns;
    const size_t n_psf = (size_t)reach * period * n;
    const size_t all = n_psf + 3 * n + 2 * period * columns + 2 * period + columns;
    light *l = calloc(1, sizeof *l + all * sizeof(double));
    assert((side & (side - 1)) == 0 && reach % 2 == 0);
    *out = l;
    if (l == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a simulator");
    l->side = side;
    l->period = 2 * side;
    l->reach = reach;
    l->columns = side + 1;
    l->psf = l->data;
    l->kx = l->psf + n_psf;
    l->phase = l->kx + n;
    l->modes = l->phase + 2 * n;
    l->line = l->modes + 2 * period * columns;
    l->power = l->line + 2 * period;
    fill_columns(l);
    fill_psf(l, psf, scale);
    return SHEAR_OK;
}

void light_free(light *l) {
    free(l);
}

/* ---- drawing ---- */

/* Compute the transform of the round galaxy for one row of modes and one alias. */
static void galaxy_row(const light *l, const light_galaxy *g, const double *kx, double ky,
                       const double *psf) {
    const double ax = g->map[0][0];
    const double bx = g->map[0][1];
    const double ay = g->map[1][0] * ky;
    const double by = g->map[1][1] * ky;
    const double h2 = g->disk_px * g->disk_px;
    const double c2 = g->bulge_px * g->bulge_px;
    const double bulge = g->bulge;
    double *power = l->power;
#pragma omp simd
    for (int m = 0; m < l->columns; m++) {
        double u = ax * kx[m] + ay;
        double v = bx * kx[m] + by;
        double q = u * u + v * v;
        double t = 1.0 + q * h2;
        double b = exp(bulge_power * log(1.0 + q * c2));
        power[m] = psf[m] * ((1.0 - bulge) / (t * sqrt(t)) + bulge * b);
    }
}

static void add_row(const light *l, const double *power, const double *phase, double ky, double y,
                    double *modes) {
    const double c = cos(ky * y);
    const double s = -sin(ky * y);
#pragma omp simd
    for (int m = 0; m < l->columns; m++) {
        modes[2 * m] += power[m] * (c * phase[2 * m] - s * phase[2 * m + 1]);
        modes[2 * m + 1] += power[m] * (c * phase[2 * m + 1] + s * phase[2 * m]);
    }
}

/* Compute the modes of a galaxy (NULL: a point) at pixel (x, y). */
static void fill_modes(light *l, const light_galaxy *g, double x, double y) {
    int n = l->reach * l->columns;
    for (int m = 0; m < n; m++) {
        l->phase[2 * m] = cos(l->kx[m] * x);
        l->phase[2 * m + 1] = -sin(l->kx[m] * x);
    }
    memset(l->modes, 0, 2 * (size_t)l->period * (size_t)l->columns * sizeof *l->modes);
    for (int i = 0; i < l->reach * l->period * l->reach; i++) {
        int r = i / l->reach;
        int at = i % l->reach * l->columns;
        const double *psf = l->psf + (size_t)r * (size_t)n + at;
        if (g != NULL)
            galaxy_row(l, g, l->kx + at, row_k(l, r), psf);
        add_row(l, g != NULL ? l->power : psf, l->phase + 2 * at, row_k(l, r), y,
                l->modes + 2 * (size_t)row_mode(l, r) * (size_t)l->columns);
    }
}

/* Transform along y: the rows of the stamp replace those of the modes. */
static void transform_columns(light *l) {
    size_t step = 2 * (size_t)l->columns;
    for (int m = 0; m < l->columns; m++) {
        double *column = l->modes + 2 * (size_t)m;
        for (int r = 0; r < l->period; r++) {
            l->line[2 * r] = column[(size_t)r * step];
            l->line[2 * r + 1] = column[(size_t)r * step + 1];
        }
        gsl_fft_complex_radix2_backward(l->line, 1, (size_t)l->period);
        for (int r = 0; r < l->side; r++) {
            column[(size_t)r * step] = l->line[2 * r];
            column[(size_t)r * step + 1] = l->line[2 * r + 1];
        }
    }
}

static void transform_rows(light *l, double *out) {
    double scale = 1.0 / ((double)l->period * l->period);
    for (int y = 0; y < l->side; y++) {
        const double *row = l->modes + 2 * (size_t)y * (size_t)l->columns;
        l->line[0] = row[0];
        l->line[l->period / 2] = row[2 * (size_t)l->side];
        for (int m = 1; m < l->period / 2; m++) {
            l->line[m] = row[2 * m];
            l->line[l->period - m] = row[2 * m + 1];
        }
        gsl_fft_halfcomplex_radix2_backward(l->line, 1, (size_t)l->period);
        for (int x = 0; x < l->side; x++)
            out[(size_t)y * (size_t)l->side + (size_t)x] = scale * l->line[x];
    }
}

void light_draw(light *l, const light_galaxy *g, double x, double y, double *out) {
    double centre = 0.5 * (l->side - 1);
    fill_modes(l, g, centre + x, centre + y);
    transform_columns(l);
    transform_rows(l, out);
}

void light_draw_psf(light *l, double *out) {
    fill_modes(l, NULL, l->side / 2, l->side / 2);
    transform_columns(l);
    transform_rows(l, out);
}
