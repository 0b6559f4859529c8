/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decide whether an image is a PSF, and what is doubtful in it. Levels are measured in rings about
 * the brightest sample; noise in fourth differences, in which everything smooth vanishes. */
#include "shear/psf.h"

#include "base/sort.h"
#include "measure/psf.h"
#include "shear/plan.h"

#include <math.h>
#include <stdbool.h>

/* ---- can it be a PSF? ---- */

/* exp(-1/2): the contour that defines R_PSF would reach an edge this bright. */
static const double edge_max = 0.6065;
/* Fraction of the flux in the outer quarters of an axis, on either side, at which the PSF lies
 * around the edges. */
static const double wrapped_min = 0.01;

typedef struct psf_image {
    const double *psf;
    int nx, ny;
    int x, y; /* the brightest sample */
} psf_image;

static double at(const psf_image *v, int x, int y) {
    return v->psf[(size_t)y * (size_t)v->nx + (size_t)x];
}

static psf_image psf_image_of(const double *psf, int nx, int ny) {
    const long peak = psf_brightest(psf, (long)nx * ny);
    return (psf_image){
        .psf = psf, .nx = nx, .ny = ny, .x = (int)(peak % nx), .y = (int)(peak / nx)};
}

static double brightest_edge(const double *psf, int nx, int ny) {
    const double *last = psf + (size_t)(ny - 1) * (size_t)nx;
    double most = psf[0];
    for (int x = 0; x < nx; x++)
        most = fmax(most, fmax(psf[x], last[x]));
    for (const double *row = psf; row <= last; row += nx)
        most = fmax(most, fmax(row[0], row[nx - 1]));
    return most;
}

static bool all_equal(const psf_image *v) {
    const size_t n = (size_t)v->nx * (size_t)v->ny;
    size_t i = 1;
    while (i < n && v->psf[i] == v->psf[0])
        i++;
    return i == n;
}

/* Return whether the peak is in an outer quarter of the axis and some of its flux in the opposite
 * one. */
static bool wraps(const psf_image *v, bool along_x) {
    const int n = along_x ? v->nx : v->ny;
    const int quarter = n / 4;
    double sum = 0.0;
    double low = 0.0;
    double high = 0.0;
    for (int y = 0; y < v->ny; y++) {
        for (int x = 0; x < v->nx; x++) {
            const int i = along_x ? x : y;
            const double value = at(v, x, y);
            sum += value;
            low += i < quarter ? value : 0.0;
            high += i >= n - quarter ? value : 0.0;
        }
    }
    const int peak = along_x ? v->x : v->y;
    const bool outer = peak < quarter || peak >= n - quarter;
    return outer && low > wrapped_min * sum && high > wrapped_min * sum && low + high > 0.5 * sum;
}

static int refuse_edge(const psf_image *v, double edge, shear_error *err) {
    const double peak = at(v, v->x, v->y);
    const bool x_wraps = wraps(v, true);
    const bool y_wraps = wraps(v, false);
    if (all_equal(v)) {
        return shear_fail(err, SHEAR_E_PSF, "give an image of the PSF, pixel response included",
                          "the PSF is flat: all its samples are %g", peak);
    }
    if (x_wraps || y_wraps) {
        return shear_fail(
            err, SHEAR_E_PSF, "put its centre into the middle: numpy.fft.fftshift(psf)",
            "the PSF lies round the image's %s: its peak is at sample (%d, %d) of "
            "%d x %d, as an FFT orders it",
            x_wraps && y_wraps ? "corners" : "edges", v->x + 1, v->y + 1, v->nx, v->ny);
    }
    if (v->x == 0 || v->y == 0 || v->x == v->nx - 1 || v->y == v->ny - 1) {
        return shear_fail(err, SHEAR_E_PSF, "cut the PSF from further around its centre",
                          "the PSF is cut through its core: its peak is at the image's edge, "
                          "sample (%d, %d) of %d x %d",
                          v->x + 1, v->y + 1, v->nx, v->ny);
    }
    return shear_fail(err, SHEAR_E_PSF,
                      "give a larger image of the PSF, and take its background off",
                      "the image's edge is as bright as %.2g of the PSF's peak", edge / peak);
}

int shear_psf_usable(const double *psf, int nx, int ny, shear_error *err) {
    double peak;
    if (psf_check(psf, nx, ny, &peak, err) != SHEAR_OK)
        return SHEAR_E_PSF;
    const double edge = brightest_edge(psf, nx, ny);
    if (edge > edge_max * peak) {
        const psf_image v = psf_image_of(psf, nx, ny);
        return refuse_edge(&v, edge, err);
    }
    return SHEAR_OK;
}

/* ---- levels about the peak ---- */

/* A level that falls no faster than this would have infinite flux beyond: it is not a wing. */
static const double pedestal_slope = 2.2;

enum { MAX_RINGS = 2050 }; /* half the largest side of a PSF, with a margin */

/* Ring i holds the samples at distances (i - 1, i] from the peak. */
typedef struct rings {
    int n; /* the last whole ring: it touches the nearest edge */
    double sum[MAX_RINGS];
    int count[MAX_RINGS], zeros[MAX_RINGS];
} rings;

static int smaller(int a, int b) {
    return a < b ? a : b;
}

/* Return the square of the distance from the peak: exact, unlike the distance, and faster. */
static double square_of_distance(const psf_image *v, int x, int y) {
    const double dx = x - v->x;
    const double dy = y - v->y;
    return dx * dx + dy * dy;
}

static void rings_fill(rings *r, const psf_image *v) {
    const int to_x = smaller(v->x, v->nx - 1 - v->x);
    const int to_y = smaller(v->y, v->ny - 1 - v->y);
    *r = (rings){.n = smaller(smaller(to_x, to_y), MAX_RINGS - 1)};
    for (int y = v->y - r->n; y <= v->y + r->n; y++) {
        for (int x = v->x - r->n; x <= v->x + r->n; x++) {
            const int i = (int)ceil(sqrt(square_of_distance(v, x, y)));
            if (i <= r->n) {
                r->sum[i] += at(v, x, y);
                r->count[i]++;
                r->zeros[i] += at(v, x, y) == 0.0;
            }
        }
    }
    /* Masked samples are not the border: the rim is where the image stops being 0. */
    while (r->n > 1 && r->zeros[r->n] > 0.9 * r->count[r->n])
        r->n--;
}

typedef struct ring_level {
    double mean;
    double distance; /* approximate: the middle */
    int count;       /* number of samples */
} ring_level;

/* Return the mean of the samples at distances from `from` to `to`, as fractions of the rim's
 * distance; at least one ring. */
static ring_level level(const rings *r, double from, double to) {
    const int last = (int)fmax(1.0, ceil(to * r->n));
    const int first = smaller(last, (int)fmax(1.0, ceil(from * r->n) + 1.0));
    ring_level l = {.distance = 0.5 * (first - 1 + last)};
    for (int i = first; i <= last; i++) {
        l.mean += r->sum[i];
        l.count += r->count[i];
    }
    l.mean /= l.count;
    return l;
}

/* ---- noise ---- */

enum { NOISE_SAMPLES = 1024, NOISE_MIN = 16 };

/* Return the fourth difference along x around (x, y); NaN unless all its samples are at distance
 * `near` or more and none is masked. */
static double fourth_difference(const psf_image *v, int x, int y, double near) {
    double s[5];
    for (int i = 0; i < 5; i++) {
        s[i] = at(v, x - 2 + i, y);
        if (s[i] == 0.0 || square_of_distance(v, x - 2 + i, y) < near * near)
            return NAN;
    }
    return s[0] + s[4] - 4.0 * (s[1] + s[3]) + 6.0 * s[2];
}

/* Return a sample's rms noise from the median absolute difference, assuming a Gaussian; NaN if
 * there are too few. */
static double noise_of(const psf_image *v, double near) {
    double found[NOISE_SAMPLES];
    int n = 0;
    const long total = (long)v->nx * v->ny;
    for (long i = 0; i < total; i += total / NOISE_SAMPLES + 1) {
        const int x = (int)(i % v->nx);
        if (x >= 2 && x < v->nx - 2) {
            const double d = fourth_difference(v, x, (int)(i / v->nx), near);
            if (!isnan(d))
                found[n++] = fabs(d);
        }
    }
    if (n < NOISE_MIN)
        return NAN;
    sort_doubles(found, (size_t)n);
    return found[n / 2] / 0.6745 / sqrt(70.0);
}

/* ---- all that an image shows ---- */

/* Return the slope between two annuli wide enough to average over Airy rings; NaN if the outer one
 * is not above the noise. */
static double slope_of(const ring_level *inner, const ring_level *outer, double noise) {
    if (!(outer->mean > 0.0))
        return INFINITY;
    const bool seen = isnan(noise) || outer->mean > 3.0 * noise / sqrt(outer->count);
    return seen ? log(inner->mean / outer->mean) / log(outer->distance / inner->distance)
                : (double)NAN;
}

/* Fill in the level at the rim, its slope, and the flux beyond if it continues so. */
static void look_beyond(shear_psf_quality *q, const rings *r, double peak, double sum,
                        double noise) {
    const ring_level outer = level(r, 0.8, 1.0);
    const ring_level inner = level(r, 0.45, 0.65);
    const double slope = slope_of(&inner, &outer, noise);
    const double to_rim = outer.distance / (r->n - 0.5);
    q->border_slope = slope;
    q->border = outer.mean / peak * (isfinite(slope) ? pow(to_rim, fmax(0.0, slope)) : 1.0);
    q->border_err = noise / peak / sqrt(outer.count);
    /* The area of a square image is treated as a circle of the same area. */
    const double edge = 2.0 / sqrt(M_PI) * (r->n + 0.5);
    const double steep = slope - 2.0;
    const double beyond = 2.0 * M_PI * outer.mean * outer.distance * outer.distance *
                          pow(outer.distance / edge, steep) / steep;
    q->cut = slope > pedestal_slope && isfinite(slope) ? beyond / (sum + beyond) : (double)NAN;
}

static double sum_of(const psf_image *v, double *lowest) {
    double sum = 0.0;
    *lowest = 0.0;
    for (size_t i = 0; i < (size_t)v->nx * (size_t)v->ny; i++) {
        sum += v->psf[i];
        *lowest = v->psf[i] < *lowest ? v->psf[i] : *lowest;
    }
    return sum;
}

int shear_psf_examine(shear_psf_quality *q, const double *psf, int nx, int ny, double oversample,
                      shear_error *err) {
    static const double sigmas = 6.0; /* by which a negative sample exceeds the noise */
    *q = (shear_psf_quality){.r_psf_px = NAN};
    if (shear_psf_usable(psf, nx, ny, err) != SHEAR_OK ||
        shear_psf_radius(psf, nx, ny, oversample, &q->r_psf_px, err) != SHEAR_OK) {
        return SHEAR_E_PSF;
    }
    const psf_image v = psf_image_of(psf, nx, ny);
    const double peak = at(&v, v.x, v.y);
    double lowest;
    const double sum = sum_of(&v, &lowest);
    rings r;
    rings_fill(&r, &v);
    const double noise = noise_of(&v, 0.75 * r.n);
    q->noise = oversample * noise / sum;
    q->lowest = lowest < -sigmas * (isnan(noise) ? 0.0 : noise) ? lowest / peak : 0.0;
    q->sampling = q->r_psf_px * oversample;
    look_beyond(q, &r, peak, sum, noise);
    q->rim_px = (double)r.n / oversample;
    return SHEAR_OK;
}

/* ---- how bad is it? ---- */

/* docs/method.md, section 3.1. */
static const double bias_max = 2e-3;
static const double border_sigmas = 4.0;
static const double lowest_min = -0.02;

static bool falls(const shear_psf_quality *q) {
    return q->border > 0.0 && q->border_slope > pedestal_slope;
}

/* The modes that count average over a disc of about the width of target and galaxy. If the rim is
 * far outside it, its level counts for less; the square of a pedestal's flux remains. */
double shear_psf_border_bias(const shear_psf_quality *q, double beta_px) {
    const double ratio = beta_px / q->r_psf_px;
    const double area = q->rim_px * q->rim_px / (q->r_psf_px * q->r_psf_px);
    const double square = falls(q) ? 0.0 : 1e-3 * pow(q->border * area, 2.0);
    const double part = falls(q) ? 2.0 / fmax(2.0, q->border_slope) : 1.0;
    const double far = q->rim_px / (q->r_psf_px * sqrt(2.0 * ratio * ratio + 5.0));
    const double seen = part * fabs(q->border) * exp(-1.1 * fmax(0.0, far - 2.8));
    return pow(ratio, 3.0) * (seen + square);
}

/* The integrals over u = k^2 of (u - beta^2 u^2/2) exp(-b^2 u), the D of a Gaussian galaxy of
 * radius R_PSF, and of its square over |W|^2, the effect of the noise. */
double shear_psf_noise_bias(const shear_psf_quality *q, double beta_px) {
    const double r2 = q->r_psf_px * q->r_psf_px;
    const double beta2 = beta_px * beta_px;
    const double b2 = beta2 + r2;
    const double a = 2.0 * b2 - r2;
    const double d = (1.0 - beta2 / b2) / (b2 * b2);
    const double square = (2.0 - 6.0 * beta2 / a + 6.0 * beta2 * beta2 / (a * a)) / (a * a * a);
    return 4.0 * M_PI * q->noise * sqrt(square / M_PI) / d;
}

/* The power that the samples' own period aliases to the wave numbers that count, about 1.5/beta,
 * for a PSF that falls a little slower than a Gaussian. All in samples. */
double shear_psf_sampling_bias(const shear_psf_quality *q, double beta_px) {
    const double k = 1.5 * q->r_psf_px / (beta_px * q->sampling);
    const double aliased = 2.0 * M_PI * fmax(0.0, M_PI - k);
    return 0.6 * exp(-0.75 * q->sampling * q->sampling * aliased);
}

static bool border_stands_out(const shear_psf_quality *q, double beta_px) {
    const double err = isnan(q->border_err) ? 0.0 : q->border_err;
    return shear_psf_border_bias(q, beta_px) > bias_max && fabs(q->border) > border_sigmas * err;
}

unsigned shear_psf_flaws(const shear_psf_quality *q, double beta_px) {
    const bool border = border_stands_out(q, beta_px);
    return (border && !falls(q) ? 1u << SHEAR_PSF_PEDESTAL : 0u) |
           (border && falls(q) ? 1u << SHEAR_PSF_CUT : 0u) |
           (shear_psf_noise_bias(q, beta_px) > bias_max ? 1u << SHEAR_PSF_NOISY : 0u) |
           (shear_psf_sampling_bias(q, beta_px) > bias_max ? 1u << SHEAR_PSF_UNDERSAMPLED : 0u) |
           (q->lowest < lowest_min ? 1u << SHEAR_PSF_NEGATIVE : 0u);
}

const char *shear_psf_flaw_name(int flaw) {
    static const char *const names[SHEAR_N_PSF_FLAWS] = {"pedestal", "cut", "noisy", "undersampled",
                                                         "negative"};
    return flaw >= 0 && flaw < SHEAR_N_PSF_FLAWS ? names[flaw] : NULL;
}

/* Return the larger of two numbers, either of which may be NaN. */
static double larger(double a, double b) {
    return b > a || isnan(a) ? b : a;
}

static void keep_worst(shear_psf_quality *w, const shear_psf_quality *q) {
    if (fabs(q->border) > fabs(w->border)) {
        w->rim_px = q->rim_px;
        w->border = q->border;
        w->border_err = q->border_err;
        w->border_slope = q->border_slope;
    }
    w->cut = larger(w->cut, q->cut);
    w->noise = larger(w->noise, q->noise);
    w->lowest = fmin(w->lowest, q->lowest);
    if (q->sampling < w->sampling) {
        w->sampling = q->sampling;
        w->r_psf_px = q->r_psf_px;
    }
}

void shear_psf_summary_add(shear_psf_summary *s, const shear_psf_quality *q, double beta_px) {
    s->looked_at++;
    if (q == NULL) {
        s->unusable++;
        return;
    }
    const unsigned flaws = shear_psf_flaws(q, beta_px);
    for (int i = 0; i < SHEAR_N_PSF_FLAWS; i++)
        s->flawed[i] += (flaws >> i) & 1u;
    if (s->looked_at - s->unusable == 1) {
        s->worst = *q;
    } else {
        keep_worst(&s->worst, q);
    }
}
