/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/star_power.h"

#include "survey/psf/least_squares.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum {
    LOW = 2, /* modes on either side of k = 0 */
    LOW_SIDE = 2 * LOW + 1,
    LOW_MODES = LOW_SIDE * LOW_SIDE - 1,
    LOW_TERMS = 4
};
/* SExtractor writes -1e30 for pixels that it does not know. */
static const double lowest_value = -1e29;
/* Flux over its noise; below it a star says little. */
static const double least_snr = 5.0;

bool star_power_init(star_power *s, int nx, int ny, int stamp) {
    *s = (star_power){0};
    s->stamp = calloc((size_t)nx * (size_t)ny, sizeof *s->stamp);
    return s->stamp != NULL && mode_power_init(&s->modes, nx, ny, 1.0, stamp);
}

void star_power_deinit(star_power *s) {
    mode_power_deinit(&s->modes);
    free(s->stamp);
    *s = (star_power){0};
}

/* ---- pixels ---- */

/* The part of an image that is used. */
typedef struct stamp_box {
    int x0, x1, y0, y1; /* first and last + 1 */
} stamp_box;

static stamp_box box_of(const mode_power *m) {
    const int w = m->nx < m->stamp ? m->nx : m->stamp;
    const int h = m->ny < m->stamp ? m->ny : m->stamp;
    const int x0 = m->nx / 2 - w / 2;
    const int y0 = m->ny / 2 - h / 2;
    return (stamp_box){x0, x0 + w, y0, y0 + h};
}

/* The border is a pixel and a sixteenth of the box wide. */
static bool in_border(const stamp_box *b, int x, int y) {
    const int w = 1 + (b->x1 - b->x0) / 16;
    const int h = 1 + (b->y1 - b->y0) / 16;
    return x < b->x0 + w || x >= b->x1 - w || y < b->y0 + h || y >= b->y1 - h;
}

static bool is_good(double value, const double *weight) {
    return isfinite(value) && value > lowest_value && (weight == NULL || *weight > 0.0);
}

/* Copy the box without the mean of its border; bad pixels, and those outside, become 0. Return
 * false if too many pixels are bad. */
static bool subtract_background(star_power *s, const double *image, const double *weights) {
    const mode_power *m = &s->modes;
    const stamp_box b = box_of(m);
    double sum = 0.0;
    int n = 0;
    int bad = 0;
    int bad_middle = 0;
    for (int y = b.y0; y < b.y1; y++) {
        for (int x = b.x0; x < b.x1; x++) {
            const ptrdiff_t i = (ptrdiff_t)y * m->nx + x;
            const bool good = is_good(image[i], weights != NULL ? weights + i : NULL);
            const bool border = in_border(&b, x, y);
            sum += good && border ? image[i] : 0.0;
            n += good && border ? 1 : 0;
            bad += good ? 0 : 1;
            bad_middle += !good && abs(x - m->nx / 2) < 4 && abs(y - m->ny / 2) < 4 ? 1 : 0;
            s->stamp[i] = good ? image[i] : NAN;
        }
    }
    if (n == 0 || bad_middle > 0 || 10 * bad > (b.x1 - b.x0) * (b.y1 - b.y0))
        return false;
    for (int y = 0; y < m->ny; y++) {
        for (int x = 0; x < m->nx; x++) {
            double *p = &s->stamp[(ptrdiff_t)y * m->nx + x];
            const bool inside = x >= b.x0 && x < b.x1 && y >= b.y0 && y < b.y1;
            *p = inside && !isnan(*p) ? *p - sum / n : 0.0;
        }
    }
    return true;
}

/* ---- modes ---- */

/* Return the mean power in the corners, beyond 3/4 of the highest k along both axes. */
static double noise_of(const double *power, int stamp) {
    double sum = 0.0;
    int n = 0;
    for (int y = 0; y < stamp; y++) {
        for (int x = 0; x < stamp; x++) {
            if (8 * abs(x - stamp / 2) > 3 * stamp && 8 * abs(y - stamp / 2) > 3 * stamp) {
                sum += power[y * stamp + x];
                n++;
            }
        }
    }
    return sum / n;
}

/* ln P is a + b jx^2 + c jx jy + d jy^2 there. */
double star_power_at_zero(const double *power, int stamp) {
    double basis[LOW_MODES * LOW_TERMS];
    double weight[LOW_MODES];
    double m[LOW_TERMS * LOW_MODES];
    double values[LOW_MODES];
    double sum = 0.0;
    for (int n = 0, j = 0; n < LOW_MODES; j++) {
        const int jx = j % LOW_SIDE - LOW;
        const int jy = j / LOW_SIDE - LOW;
        if (jx == 0 && jy == 0)
            continue;
        const double terms[LOW_TERMS] = {1.0, jx * jx, jx * jy, jy * jy};
        memcpy(basis + (ptrdiff_t)LOW_TERMS * n, terms, sizeof terms);
        const double p = power[(stamp / 2 + jy) * stamp + stamp / 2 + jx];
        values[n] = p > 0.0 ? log(p) : NAN;
        weight[n++] = 1.0;
    }
    if (!least_squares_matrix(basis, weight, LOW_MODES, LOW_TERMS, m))
        return NAN;
    for (int i = 0; i < LOW_MODES; i++)
        sum += m[i] * values[i];
    return exp(sum);
}

bool star_power_of(star_power *s, const double *image, const double *weights, double *power,
                   double *level) {
    const int stamp = s->modes.stamp;
    if (!subtract_background(s, image, weights))
        return false;
    mode_power_of(&s->modes, s->stamp, power);
    const double noise = noise_of(power, stamp);
    for (int j = 0; j < stamp * stamp; j++)
        power[j] -= noise;
    const double zero = star_power_at_zero(power, stamp);
    *level = noise / zero;
    if (!(zero > 0.0) || !isfinite(zero) || !(*level * least_snr * least_snr < 1.0))
        return false;
    for (int j = 0; j < stamp * stamp; j++)
        power[j] /= zero;
    power[stamp / 2 * (stamp + 1)] = 1.0;
    return true;
}
