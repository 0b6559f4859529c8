/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/saturation.h"

#include "base/simd.h"
#include "base/sort.h"
#include "shear/stamp.h"

#include <math.h>

enum { LEAST = 4 }; /* pixels in a flat top */
static const double above_sky = 2.0;
static const double window_sigma = 3.0;
static const double log_chance = -18.4; /* ln of 1e-8 */

/* Count the pixels of a strip that have this value. */
SHEAR_SIMD static int count_equal(const double *strip, size_t nx, size_t ny, double value) {
    int lanes[FFT_LANES] = {0};
    for (size_t y = 0; y < ny; y++) {
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++)
            lanes[l] += strip[y * nx + l] == value ? 1 : 0;
    }
    int n = 0;
    for (size_t l = 0; l < FFT_LANES; l++)
        n += lanes[l];
    return n;
}

bool saturation_suspected(const artefact_pair *pair, double sigma) {
    const double most = pair->ph->galaxy_most;
    int n = 0;
    if (!(sigma > 0.0) || !(most > pair->ph->noise_mean + above_sky * sigma))
        return false;
    for (int i = 0; i * FFT_LANES < pair->nx && n < LEAST; i++) {
        if (pair->strip_most[i] == most) {
            n += count_equal(pair->galaxy + artefact_strip_start(pair, i), (size_t)pair->nx,
                             (size_t)pair->ny, most);
        }
    }
    return n >= LEAST;
}

/* Return the smallest difference between pixels of the border; INFINITY if all are equal. */
static double step_of(const artefact_pair *pair) {
    double values[4 * SHEAR_MAX_SIDE];
    const size_t n = artefact_border(pair->galaxy, pair->nx, pair->ny, values);
    double step = INFINITY;
    sort_doubles(values, n);
    for (size_t i = 1; i < n; i++) {
        const double difference = values[i] - values[i - 1];
        step = difference > 0.0 && difference < step ? difference : step;
    }
    return step;
}

/* The number of pixels with the largest value, with the next value, and within `window` of the
 * largest. */
typedef struct top {
    int n, n_next, n_near;
    double next;
    int x, y; /* place of the first one */
} top;

static top top_of(const artefact_pair *pair, double window) {
    const double most = pair->ph->galaxy_most;
    top t = {.next = -INFINITY, .x = -1, .y = -1};
    for (int y = 0; y < pair->ny; y++) {
        for (int x = 0; x < pair->nx; x++) {
            const double p = pair->galaxy[(size_t)y * (size_t)pair->nx + (size_t)x];
            if (p == most) {
                t.x = t.n == 0 ? x : t.x;
                t.y = t.n == 0 ? y : t.y;
                t.n++;
                continue;
            }
            t.n_near += p > most - window;
            t.n_next = p > t.next ? 1 : t.n_next + (p == t.next);
            t.next = p > t.next ? p : t.next;
        }
    }
    return t;
}

/* Return whether n equal pixels are too unlikely to come from noise, if `expected` more than one
 * are expected: a bound on Poisson's law. */
static bool is_unlikely(int n, double expected) {
    const double more = n - 1;
    return more > expected && more * (log(expected / more) + 1.0) - expected < log_chance;
}

artefact saturation_find(const artefact_pair *pair, double sigma) {
    const artefact none = {.x = -1, .y = -1};
    const double step = step_of(pair);
    if (!isfinite(step))
        return none;
    const double window = fmax(window_sigma * sigma, 2.0 * step);
    const top t = top_of(pair, window);
    const double expected = (t.n_near + 2) * step / window;
    const bool is_one = t.n >= LEAST && 3 * t.n_next < t.n && is_unlikely(t.n, expected);
    return is_one ? (artefact){.x = t.x, .y = t.y} : none;
}
