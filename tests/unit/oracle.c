/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "oracle.h"

#include "test.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>

static double *numbers(size_t n) {
    double *out = calloc(n, sizeof *out);
    assert_non_null(out);
    return out;
}

static bool is_log(enum shear_interpolation method) {
    return method == SHEAR_INTERP_LOG_BILINEAR || method == SHEAR_INTERP_LOG_BICUBIC ||
           method == SHEAR_INTERP_LOG_SPLINE;
}

/* ---- step 1: interpolation; -INFINITY is the logarithm of a zero
 * --------------------------------------- */

/* First derivatives, eq. (14) of Zhang (2010): central, one-sided at both ends. */
static void derivatives(int n, const double *f, double *e) {
    for (int i = 0; i < n; i++) {
        const int a = i > 0 ? i - 1 : 0;
        const int b = i < n - 1 ? i + 1 : n - 1;
        e[i] = b > a ? (f[b] - f[a]) / (b - a) : 0.0;
    }
}

/* Second derivatives of the natural spline: (e_{i-1} + 4 e_i + e_{i+1}) / 6 = f_{i+1} - 2 f_i +
 * f_{i-1} for the inner points, e = 0 at the ends; Gaussian elimination on the full matrix. */
static void second_derivatives(int n, const double *f, double *e) {
    double *m = numbers((size_t)n * (size_t)n);
    for (int i = 0; i < n; i++) {
        e[i] = 0.0;
        m[i * n + i] = 1.0;
        if (i > 0 && i < n - 1) {
            m[i * n + i - 1] = m[i * n + i + 1] = 1.0 / 6.0;
            m[i * n + i] = 4.0 / 6.0;
            e[i] = f[i + 1] - 2.0 * f[i] + f[i - 1];
        }
    }
    for (int pivot = 0; pivot < n; pivot++) {
        for (int i = 0; i < n; i++) {
            const double factor = i == pivot ? 0.0 : m[i * n + pivot] / m[pivot * n + pivot];
            for (int j = pivot; j < n && factor != 0.0; j++)
                m[i * n + j] -= factor * m[pivot * n + j];
            e[i] -= factor * e[pivot];
        }
    }
    for (int i = 0; i < n; i++)
        e[i] /= m[i * n + i];
    free(m);
}

/* Eqs. (12), (15) and (17) in one dimension, at t between two points. */
static double between(enum shear_interpolation method, double t, double f0, double f1, double e0,
                      double e1) {
    const double h = 1.0 - t;
    switch (method) {
    case SHEAR_INTERP_BICUBIC:
    case SHEAR_INTERP_LOG_BICUBIC: /* the cubic with values f and derivatives e at its ends */
        return f0 +
               t * (e0 + t * (3.0 * (f1 - f0) - 2.0 * e0 - e1 + t * (2.0 * (f0 - f1) + e0 + e1)));
    case SHEAR_INTERP_SPLINE:
    case SHEAR_INTERP_LOG_SPLINE:
        return h * f0 + t * f1 + (h * h * h - h) / 6.0 * e0 + (t * t * t - t) / 6.0 * e1;
    default:
        return h * f0 + t * f1;
    }
}

/* What the method wants of a line of n points besides their values, each unbroken stretch of
 * non-zero pixels by itself. Points lie `step` numbers apart; `marks` says which are zeros. */
static void line_slopes(enum shear_interpolation method, int n, int step, const double *marks,
                        const double *f, double *e) {
    double *line = numbers(2 * (size_t)n);
    for (int from = 0, to; from < n; from = to + 1) {
        for (to = from; to < n && marks[to * step] != -INFINITY; to++)
            line[to] = f[to * step];
        if (method == SHEAR_INTERP_SPLINE || method == SHEAR_INTERP_LOG_SPLINE) {
            second_derivatives(to - from, line + from, line + n + from);
        } else {
            derivatives(to - from, line + from, line + n + from);
        }
    }
    for (int i = 0; i < n; i++)
        e[i * step] = line[n + i];
    free(line);
}

/* The numbers at the pixels that fix the surface: value, slope along x, along y, and the mixed one.
 * Beside zeros it matters in which order the two slopes of the mixed one are taken; their mean
 * prefers neither axis. */
typedef struct surface {
    enum shear_interpolation method;
    int nx, ny;
    double *f, *fx, *fy, *fxy, *fyx; /* [ny][nx] */
} surface;

static void fill_slopes(surface *s) {
    for (int y = 0; y < s->ny; y++)
        line_slopes(s->method, s->nx, 1, s->f + y * s->nx, s->f + y * s->nx, s->fx + y * s->nx);
    for (int x = 0; x < s->nx; x++) {
        line_slopes(s->method, s->ny, s->nx, s->f + x, s->f + x, s->fy + x);
        line_slopes(s->method, s->ny, s->nx, s->f + x, s->fx + x, s->fxy + x);
    }
    for (int y = 0; y < s->ny; y++)
        line_slopes(s->method, s->nx, 1, s->f + y * s->nx, s->fy + y * s->nx, s->fyx + y * s->nx);
}

/* The surface t of the way from pixel (x, y) to the next in x, and u in y. Beyond the last pixel it
 * is linear to the first, where the period closes. A cell with a zero at one of the corners that
 * count is zero. */
static double surface_at(const surface *s, int x, int y, double t, double u) {
    const int x1 = x == s->nx - 1 ? 0 : x + 1;
    const int y1 = y == s->ny - 1 ? 0 : y + 1;
    const int corner[2][2] = {{y * s->nx + x, y * s->nx + x1}, {y1 * s->nx + x, y1 * s->nx + x1}};
    const enum shear_interpolation across = x1 == 0 ? SHEAR_INTERP_BILINEAR : s->method;
    const enum shear_interpolation up = y1 == 0 ? SHEAR_INTERP_BILINEAR : s->method;
    double f[2] = {0.0, 0.0};
    double e[2] = {0.0, 0.0};
    for (int row = 0; row <= (u > 0.0); row++) {
        const int a = corner[row][0];
        const int b = t > 0.0 ? corner[row][1] : a;
        if (s->f[a] == -INFINITY || s->f[b] == -INFINITY)
            return -INFINITY;
        f[row] = between(across, t, s->f[a], s->f[b], s->fx[a], s->fx[b]);
        e[row] = between(across, t, s->fy[a], s->fy[b], 0.5 * (s->fxy[a] + s->fyx[a]),
                         0.5 * (s->fxy[b] + s->fyx[b]));
    }
    return u > 0.0 ? between(up, u, f[0], f[1], e[0], e[1]) : f[0];
}

/* What is interpolated: the pixels, or their logarithms with zeros as the policy says. */
static double *prepare(const double *pixels, size_t n, enum shear_interpolation method,
                       enum shear_zeros zeros, double pedestal) {
    double *out = numbers(n);
    double peak = 0.0;
    bool has_zero = false;
    for (size_t i = 0; i < n; i++) {
        out[i] = pixels[i] + (is_log(method) ? pedestal : 0.0);
        peak = fmax(peak, out[i]);
        has_zero = has_zero || out[i] == 0.0;
    }
    const double tiny = zeros == SHEAR_ZEROS_FLOOR && has_zero ? 1e-12 * peak : 0.0;
    for (size_t i = 0; i < n && is_log(method); i++)
        out[i] = log(fmax(out[i], tiny));
    return out;
}

double *oracle_interpolate(const double *pixels, int nx, int ny,
                           enum shear_interpolation interpolation, int s, enum shear_zeros zeros,
                           double pedestal) {
    const size_t n = (size_t)nx * (size_t)ny;
    double *slopes = numbers(4 * n);
    surface surf = {.method = interpolation,
                    .nx = nx,
                    .ny = ny,
                    .f = prepare(pixels, n, interpolation, zeros, pedestal),
                    .fx = slopes,
                    .fy = slopes + n,
                    .fxy = slopes + 2 * n,
                    .fyx = slopes + 3 * n};
    fill_slopes(&surf);
    double *fine = numbers(n * (size_t)s * (size_t)s);
    for (int y = 0; y < ny * s; y++) {
        for (int x = 0; x < nx * s; x++) {
            const double f =
                surface_at(&surf, x / s, y / s, (double)(x % s) / s, (double)(y % s) / s);
            fine[y * nx * s + x] = is_log(interpolation) ? exp(f) - pedestal : f;
        }
    }
    free(surf.f);
    free(slopes);
    return fine;
}

/* ---- step 2: the filter
 * -------------------------------------------------------------------------------- */

double oracle_filter(int nx, int ny, int s, int x, int y, double core, double width) {
    /* The shortest way to the centre on the periodic stamp. */
    const double dx = remainder((double)x / s - 0.5 * (nx - 1), nx);
    const double dy = remainder((double)y / s - 0.5 * (ny - 1), ny);
    const double r = hypot(dx, dy);
    return r <= core ? 1.0 : exp(-0.5 * pow((r - core) / width, 2.0));
}

static void apply_filter(double *image, double level, const shear_plan_info *info) {
    for (int y = 0; y < info->fine_ny && info->filter != SHEAR_FILTER_NONE; y++) {
        for (int x = 0; x < info->fine_nx; x++) {
            double *pixel = &image[y * info->fine_nx + x];
            *pixel = (*pixel - level) * oracle_filter(info->geometry.nx, info->geometry.ny,
                                                      info->oversample, x, y, info->core_px,
                                                      info->width_px);
        }
    }
}

/* ---- steps 3 to 6
 * --------------------------------------------------------------------------------------- */

/* A square table of one number for every mode |jx| <= mx, |jy| <= my. */
typedef struct modes {
    int mx, my;
    double *at; /* [2 my + 1][2 mx + 1] */
} modes;

static double *mode(const modes *m, int jx, int jy) {
    return m->at + (jy + m->my) * (2 * m->mx + 1) + jx + m->mx;
}

static modes modes_new(int mx, int my) {
    return (modes){.mx = mx, .my = my, .at = numbers((size_t)(2 * mx + 1) * (size_t)(2 * my + 1))};
}

/* exp(-2 pi i j / period), j from 0. */
static double complex *waves(int period) {
    double complex *wave = calloc((size_t)period, sizeof *wave);
    assert_non_null(wave);
    for (int j = 0; j < period; j++)
        wave[j] = cexp(-2.0 * I * M_PI * j / period);
    return wave;
}

/* |F|^2 of a real image at k = 2 pi (jx / period_x, jy / period_y) a sample, by the sum that
 * defines it, first along x, then along y. */
static void image_power(const double *image, int nx, int ny, int period_x, int period_y,
                        modes *out) {
    double complex *column = calloc((size_t)ny, sizeof *column);
    assert_non_null(column);
    double complex *wave_x = waves(period_x);
    double complex *wave_y = waves(period_y);
    for (int jx = -out->mx; jx <= out->mx; jx++) {
        for (int y = 0; y < ny; y++) {
            column[y] = 0.0;
            for (int x = 0; x < nx; x++) {
                column[y] +=
                    image[y * nx + x] * wave_x[((jx * x) % period_x + period_x) % period_x];
            }
        }
        for (int jy = -out->my; jy <= out->my; jy++) {
            double complex f = 0.0;
            for (int y = 0; y < ny; y++)
                f += column[y] * wave_y[((jy * y) % period_y + period_y) % period_y];
            *mode(out, jx, jy) = creal(f) * creal(f) + cimag(f) * cimag(f);
        }
    }
    free(column);
    free(wave_x);
    free(wave_y);
}

/* The PSF is not periodic: what interpolation puts beyond its last sample is not part of it. */
static void cut_closing_cells(double *fine, int nx, int ny, int factor) {
    for (int y = 0; y < ny * factor; y++) {
        for (int x = 0; x < nx * factor; x++) {
            const bool inside = x <= (nx - 1) * factor && y <= (ny - 1) * factor;
            fine[y * nx * factor + x] *= inside ? 1.0 : 0.0;
        }
    }
}

/* |W|^2, 1 at k = 0, and the smallest |k| where it is below the threshold: at most Nyquist's. */
static double psf_power(const shear_plan_info *info, const shear_settings *settings,
                        const double *psf, modes *out) {
    const shear_geometry *g = &info->geometry;
    const int q = (int)info->psf_oversample;
    const int factor = q / (int)g->psf_oversample;
    double *fine = oracle_interpolate(psf, g->psf_nx, g->psf_ny, info->interpolation, factor,
                                      settings->zeros, 0.0);
    cut_closing_cells(fine, g->psf_nx, g->psf_ny, factor);
    double cut = M_PI * fmin(info->oversample, q);
    image_power(factor > 1 ? fine : psf, g->psf_nx * factor, g->psf_ny * factor, g->nx * q,
                g->ny * q, out);
    const double peak = *mode(out, 0, 0);
    for (int jy = -out->my; jy <= out->my; jy++) {
        for (int jx = -out->mx; jx <= out->mx; jx++) {
            *mode(out, jx, jy) /= peak;
            if (*mode(out, jx, jy) < settings->psf_threshold)
                cut = fmin(cut, hypot(2.0 * M_PI * jx / g->nx, 2.0 * M_PI * jy / g->ny));
        }
    }
    free(fine);
    return cut;
}

/* P = T |F|^2 summed with the six weights; `sign` is that of the stamp in the difference of
 * eq. (8). */
static void add_moments(shear_row *row, const shear_plan_info *info, const modes *power,
                        const modes *psf, double cut, double sign) {
    const double beta = info->beta_px;
    const double points =
        (double)info->geometry.nx * info->geometry.ny * pow(info->oversample, 4.0);
    for (int jy = -power->my; jy <= power->my; jy++) {
        for (int jx = -power->mx; jx <= power->mx; jx++) {
            const double kx = 2.0 * M_PI * jx / info->geometry.nx;
            const double ky = 2.0 * M_PI * jy / info->geometry.ny;
            const double k2 = kx * kx + ky * ky;
            if (sqrt(k2) >= cut * (1.0 - 1e-12))
                continue;
            const double t = exp(-beta * beta * k2) / *mode(psf, jx, jy);
            const double p = sign * t * *mode(power, jx, jy) / points;
            row->m20 += kx * kx * p;
            row->m02 += ky * ky * p;
            row->m11 += kx * ky * p;
            row->m4 += k2 * k2 * p;
            row->u += (pow(kx, 4.0) - 6.0 * kx * kx * ky * ky + pow(ky, 4.0)) * p;
            row->v += (kx * kx * kx * ky - kx * ky * ky * ky) * p;
        }
    }
}

/* METHOD section 4: the mean of |F|^2 at |k| > 3/4 of Nyquist over the stamp's nx x ny modes, off
 * every mode. */
static void take_plateau_off(const modes *power, const shear_plan_info *info) {
    const int nx = info->geometry.nx;
    const int ny = info->geometry.ny;
    double sum = 0.0;
    double n = 0.0;
    for (int jy = -(ny / 2); jy <= (ny - 1) / 2; jy++) {
        for (int jx = -(nx / 2); jx <= (nx - 1) / 2; jx++) {
            const double part_of_nyquist = 2.0 * hypot((double)jx / nx, (double)jy / ny);
            if (part_of_nyquist > 0.75 * (1.0 + 1e-12)) {
                sum += *mode(power, jx, jy);
                n += 1.0;
            }
        }
    }
    for (int i = 0; i < (2 * power->mx + 1) * (2 * power->my + 1); i++)
        power->at[i] -= sum / n;
}

static void add_stamp(shear_row *row, const shear_plan_info *info, const shear_settings *settings,
                      const double *pixels, double level, const modes *psf, double cut,
                      double sign) {
    double *fine =
        oracle_interpolate(pixels, info->geometry.nx, info->geometry.ny, info->interpolation,
                           info->oversample, settings->zeros, settings->pedestal);
    modes power = modes_new(psf->mx, psf->my);
    apply_filter(fine, level, info);
    image_power(fine, info->fine_nx, info->fine_ny, info->fine_nx, info->fine_ny, &power);
    if (settings->shot_noise == SHEAR_SHOT_PLATEAU)
        take_plateau_off(&power, info);
    add_moments(row, info, &power, psf, cut, sign);
    free(power.at);
    free(fine);
}

/* METHOD section 2: a third difference of the stamp along an axis, pixels i in [0, n) of which have
 * the weight 1/(pixels of the strip) times 1, -c, 0, c, -1; as many times what it would be of white
 * noise of the pixels' mean's variance. */
static double third(const double *pixels, int nx, int ny, bool along_x) {
    const int n = along_x ? nx : ny;
    const int across = along_x ? ny : nx;
    const int q = n / 4;
    const int h = n / 2;
    const double c = (n - q) / (double)(n - q - h);
    double value = 0.0;
    double squares = 0.0;
    for (int y = 0; y < ny; y++) {
        for (int x = 0; x < nx; x++) {
            const int i = along_x ? x : y;
            const int end = n - 1 - i;
            const double w = i < q     ? 1.0 / (q * across)
                             : i < h   ? -c / ((h - q) * across)
                             : end < q ? -1.0 / (q * across)
                             : end < h ? c / ((h - q) * across)
                                       : 0.0;
            value += w * pixels[y * nx + x];
            squares += w * w;
        }
    }
    return value / sqrt(squares * nx * ny);
}

/* What the galaxy stamp loses; `own`: what the noise stamp loses. */
static double level_of(const double *noise, int nx, int ny, double *own) {
    double mean = 0.0;
    for (int i = 0; i < nx * ny; i++)
        mean += noise[i] / (nx * ny);
    *own = mean + hypot(third(noise, nx, ny, true), third(noise, nx, ny, false));
    return mean;
}

shear_row oracle_measure(const shear_plan_info *info, const shear_settings *settings,
                         const double *galaxy, const double *noise, const double *psf,
                         double *k_cut) {
    shear_row row = {0};
    /* Modes on the edge of the fine grid's band lie outside any circle inside it. */
    const int finest =
        info->oversample < info->psf_oversample ? info->oversample : (int)info->psf_oversample;
    modes of_psf = modes_new(info->geometry.nx * finest / 2, info->geometry.ny * finest / 2);
    *k_cut = psf_power(info, settings, psf, &of_psf);
    double level = 0.0;
    double own = 0.0;
    if (settings->background != SHEAR_BACKGROUND_KEEP && info->filter != SHEAR_FILTER_NONE)
        level = level_of(noise, info->geometry.nx, info->geometry.ny, &own);
    add_stamp(&row, info, settings, galaxy, level, &of_psf, *k_cut, 1.0);
    if (settings->noise_correction)
        add_stamp(&row, info, settings, noise, own, &of_psf, *k_cut, -1.0);
    row.n1 = -(row.m20 - row.m02) / 2.0;
    row.n2 = -row.m11;
    row.d = row.m20 + row.m02 - info->beta_px * info->beta_px / 2.0 * row.m4;
    free(of_psf.at);
    return row;
}
