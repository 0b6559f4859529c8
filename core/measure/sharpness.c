/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/sharpness.h"

#include <math.h>

/* Places between the pixels are at most a quarter of a pixel apart. */
enum { PLACES = 4 };

/* Below this fraction of the peak, an image of a PSF is noise, or cut off. */
static const double faint = 0.02;
/* What a sample this faint exceeds any bound by is within the tolerance of artefact.c. */
static const double negligible = 1e-4;

typedef struct sampled_psf {
    psf_view image;
    int q;    /* samples per pixel */
    int fine; /* places per sample, along each axis */
} sampled_psf;

/* The brightest sample and the sum of an image. */
typedef struct level {
    double peak, sum;
} level;

static level level_of(const psf_view *v) {
    level all = {0};
    for (long i = 0; i < (long)v->nx * v->ny; i++) {
        all.peak = fmax(all.peak, v->psf[i]);
        all.sum += v->psf[i];
    }
    return all;
}

typedef struct cell {
    double at[PLACES * PLACES];
} cell;

static double sample(const sampled_psf *v, int x, int y) {
    return psf_sample(&v->image, x, y);
}

static cell cell_of(const sampled_psf *v, int x, int y) {
    cell c = {{0}};
    if (v->fine == 1) {
        c.at[0] = sample(v, x, y);
    } else {
        psf_refine(&v->image, x, y, v->fine, c.at);
    }
    return c;
}

/* The largest ratio so far, and its place. */
typedef struct summit {
    double ratio, x, y; /* samples */
} summit;

static double ratio_of(double here, double left, double right, double below, double above) {
    const double around = 0.5 * fmin(left + right, below + above);
    return around > 0.0 ? here / around : INFINITY;
}

/* Try the places of one sample. */
static void try_places(const sampled_psf *v, int x, int y, double least, summit *best) {
    const cell here = cell_of(v, x, y);
    const cell left = cell_of(v, x - v->q, y);
    const cell right = cell_of(v, x + v->q, y);
    const cell below = cell_of(v, x, y - v->q);
    const cell above = cell_of(v, x, y + v->q);
    for (int i = 0; i < v->fine * v->fine; i++) {
        const double ratio =
            ratio_of(here.at[i], left.at[i], right.at[i], below.at[i], above.at[i]);
        if (here.at[i] > least && ratio > best->ratio) {
            *best = (summit){.ratio = ratio,
                             .x = x + (double)(i % v->fine) / v->fine,
                             .y = y + (double)(i / v->fine) / v->fine};
        }
    }
}

static double at(const sampled_psf *v, double x, double y) {
    return psf_at(&v->image, x, y);
}

static void try_at(const sampled_psf *v, double x, double y, double least, summit *best) {
    const double here = at(v, x, y);
    const double ratio = ratio_of(here, at(v, x - v->q, y), at(v, x + v->q, y), at(v, x, y - v->q),
                                  at(v, x, y + v->q));
    if (here > least && ratio > best->ratio)
        *best = (summit){.ratio = ratio, .x = x, .y = y};
}

/* Climb from the best place, with halved steps: for a narrow PSF the ratio has a sharp peak,
 * too. */
static void climb(const sampled_psf *v, double least, summit *best) {
    static const double smallest_px = 1.0 / 256.0;
    for (double step = 0.5 / v->fine; step > smallest_px * v->q && isfinite(best->ratio);) {
        const summit before = *best;
        try_at(v, before.x - step, before.y, least, best);
        try_at(v, before.x + step, before.y, least, best);
        try_at(v, best->x, before.y - step, least, best);
        try_at(v, best->x, before.y + step, least, best);
        step *= best->ratio > before.ratio ? 1.0 : 0.5;
    }
}

static double excess_at(const sampled_psf *v, int x, int y, double ratio) {
    const double rows = sample(v, x - v->q, y) + sample(v, x + v->q, y);
    const double columns = sample(v, x, y - v->q) + sample(v, x, y + v->q);
    return sample(v, x, y) - ratio * 0.5 * fmax(0.0, fmin(rows, columns));
}

static double largest_ratio(const sampled_psf *v, double least) {
    summit best = {.ratio = 1.0};
    for (int y = -1; y < v->image.ny; y++) { /* including places before the first sample */
        for (int x = -1; x < v->image.nx; x++) {
            const double near = fmax(fmax(sample(v, x, y), sample(v, x + 1, y)),
                                     fmax(sample(v, x, y + 1), sample(v, x + 1, y + 1)));
            if (near > least)
                try_places(v, x, y, least, &best);
        }
    }
    if (best.ratio > 1.0)
        climb(v, least, &best);
    return best.ratio;
}

/* The sharpness of an image with a whole number of samples per pixel. */
static sharpness of_whole(const double *psf, int nx, int ny, int q) {
    const sampled_psf v = {.image = {.psf = psf, .nx = nx, .ny = ny},
                           .q = q,
                           .fine = q < PLACES ? (PLACES + q - 1) / q : 1};
    const level all = level_of(&v.image);
    sharpness s = {.ratio = largest_ratio(&v, faint * all.peak), .leak = 0.0};
    if (!(all.peak > 0.0) || !(all.sum > 0.0) || !isfinite(s.ratio))
        return (sharpness){.ratio = INFINITY};
    for (int y = 0; y < ny; y++) {
        for (int x = 0; x < nx; x++)
            s.leak = fmax(s.leak, excess_at(&v, x, y, s.ratio));
    }
    s.leak *= (double)q * q / all.sum; /* the sum of its pixels is sum / q^2 */
    return s;
}

/* ---- pixels that lie between the samples ---- */

/* The means of the neighbours at (x, y), the smaller one. */
static double around(const psf_view *v, double x, double y, const double *to_x,
                     const double *to_y) {
    const double row = psf_at(v, x - to_x[0], y - to_x[1]) + psf_at(v, x + to_x[0], y + to_x[1]);
    const double column = psf_at(v, x - to_y[0], y - to_y[1]) + psf_at(v, x + to_y[0], y + to_y[1]);
    return 0.5 * fmin(row, column);
}

/* Return the largest ratio at the places about sample (x, y). */
static double ratio_near(const psf_view *v, int x, int y, int fine, const double *to_x,
                         const double *to_y) {
    double most = 1.0;
    for (int i = 0; i < fine * fine; i++) {
        const double at_x = x + (double)(i % fine) / fine;
        const double at_y = y + (double)(i / fine) / fine;
        const double mean = around(v, at_x, at_y, to_x, to_y);
        most = fmax(most, mean > 0.0 ? psf_at(v, at_x, at_y) / mean : INFINITY);
    }
    return most;
}

sharpness sharpness_on_pixels(const psf_view *v, const double *to_x, const double *to_y) {
    const double area = fabs(to_x[0] * to_y[1] - to_x[1] * to_y[0]);
    const int fine = area < PLACES * PLACES ? (int)ceil(PLACES / sqrt(fmax(1.0, area))) : 1;
    const level all = level_of(v);
    sharpness s = {.ratio = 1.0, .leak = 0.0};
    for (int y = 0; y < v->ny; y++) {
        for (int x = 0; x < v->nx; x++) {
            if (psf_sample(v, x, y) > faint * all.peak)
                s.ratio = fmax(s.ratio, ratio_near(v, x, y, fine, to_x, to_y));
        }
    }
    if (!(all.peak > 0.0) || !(all.sum > 0.0) || !isfinite(s.ratio))
        return (sharpness){.ratio = INFINITY};
    for (int y = 0; y < v->ny; y++) {
        for (int x = 0; x < v->nx; x++) {
            const double here = psf_sample(v, x, y);
            if (here > fmax(s.leak, negligible * all.peak)) {
                const double mean = fmax(0.0, around(v, x, y, to_x, to_y));
                s.leak = fmax(s.leak, here - s.ratio * mean);
            }
        }
    }
    s.leak *= area / all.sum;
    return s;
}

sharpness sharpness_of(const double *psf, int nx, int ny, double q) {
    const psf_view view = {.psf = psf, .nx = nx, .ny = ny};
    const double x[2] = {q, 0.0};
    const double y[2] = {0.0, q};
    return q == floor(q) ? of_whole(psf, nx, ny, (int)q) : sharpness_on_pixels(&view, x, y);
}
