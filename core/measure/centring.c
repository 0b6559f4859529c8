/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Find the light of galaxies, which should be where their positions are. */
#include "shear/centring.h"

#include "base/sort.h"

#include <math.h>
#include <stdlib.h>

enum { REACH = 8, SPOT = 2, FEWEST = 20, RARE = 7, FEWEST_FOUND = 8 };

static const double brighter = 1.5, most_px = 0.5, errors = 5.0, scattered_px = 2.0;
/* A normal distribution's standard deviation over its median absolute deviation, times the error of
 * its median over that of its mean. */
static const double of_median = 1.4826 * 1.2533;

/* A stamp around its middle pixel. */
typedef struct view {
    const double *pixels; /* [ny][nx] */
    int nx, ny;
} view;

/* Return the mean of the 3 x 3 pixels around a place from the middle. */
static double smooth(const view *v, int x, int y) {
    double sum = 0.0;
    for (int j = y - 1; j <= y + 1; j++) {
        const double *row = v->pixels + (ptrdiff_t)(v->ny / 2 + j) * v->nx + v->nx / 2 + x;
        sum += row[-1] + row[0] + row[1];
    }
    return sum / 9.0;
}

/* Return how far the smoothed stamp reaches from the middle, at most REACH. */
static int reach_of(int n) {
    const int whole = (n - 1) / 2 - 1;
    return whole < REACH ? whole : REACH;
}

/* Find the brightest place; return its brightness above the mean of all. */
static double find_peak(const view *v, int *x, int *y) {
    const int rx = reach_of(v->nx);
    const int ry = reach_of(v->ny);
    double sum = 0.0;
    double peak = -INFINITY;
    for (int j = -ry; j <= ry; j++) {
        for (int i = -rx; i <= rx; i++) {
            const double value = smooth(v, i, j);
            sum += value;
            if (value > peak) {
                peak = value;
                *x = i;
                *y = j;
            }
        }
    }
    return peak - sum / ((2.0 * rx + 1.0) * (2.0 * ry + 1.0));
}

/* Find the centre of what is brighter than half the peak, around it. */
static void find_centre(const view *v, int x, int y, double *dx, double *dy) {
    const double level = 0.5 * smooth(v, x, y);
    double sum = 0.0;
    *dx = *dy = 0.0;
    for (int j = -SPOT; j <= SPOT; j++) {
        for (int i = -SPOT; i <= SPOT; i++) {
            if (abs(x + i) > reach_of(v->nx) || abs(y + j) > reach_of(v->ny))
                continue;
            const double above = fmax(smooth(v, x + i, y + j) - level, 0.0);
            sum += above;
            *dx += above * i;
            *dy += above * j;
        }
    }
    *dx = x + (sum > 0.0 ? *dx / sum : 0.0);
    *dy = y + (sum > 0.0 ? *dy / sum : 0.0);
}

/* Return the distance of a position from the middle of its pixel. */
static double fraction(double position) {
    return position - floor(position + 0.5);
}

bool shear_centring_find(const shear_stamps *stamps, int i, double x, double y, double *dx,
                         double *dy) {
    const size_t n = (size_t)stamps->nx * (size_t)stamps->ny;
    const size_t planes = stamps->noise_planes > 1 ? (size_t)stamps->noise_planes : 1;
    const view galaxy = {stamps->galaxy + (size_t)i * n, stamps->nx, stamps->ny};
    const view noise = {stamps->noise + (size_t)i * planes * n, stamps->nx, stamps->ny};
    int px = 0;
    int py = 0;
    *dx = *dy = 0.0;
    const double of_noise = find_peak(&noise, &px, &py);
    const double of_galaxy = find_peak(&galaxy, &px, &py);
    const bool found = of_galaxy > 0.0 && of_galaxy > brighter * of_noise;
    if (found) {
        find_centre(&galaxy, px, py, dx, dy);
        *dx -= fraction(x);
        *dy -= fraction(y);
    }
    return found;
}

/* Return the median, and its error. Sorts the values, and leaves their deviations. */
static double median_of(double *v, int64_t n, double *err) {
    *err = NAN;
    if (n == 0)
        return NAN;
    sort_doubles(v, (size_t)n);
    const double median = 0.5 * (v[(n - 1) / 2] + v[n / 2]);
    for (int64_t i = 0; i < n; i++)
        v[i] = fabs(v[i] - median);
    sort_doubles(v, (size_t)n);
    if (n > 1)
        *err = of_median * v[n / 2] / sqrt((double)n);
    return median;
}

void shear_centring_summarize(shear_centring *c, int64_t looked_at, double *dx, double *dy,
                              int64_t found) {
    *c = (shear_centring){.looked_at = looked_at, .found = found};
    c->x = median_of(dx, found, &c->x_err);
    c->y = median_of(dy, found, &c->y_err);
}

bool shear_centring_is_off(const shear_centring *c) {
    return c->found >= FEWEST && (fabs(c->x) > fmax(most_px, errors * c->x_err) ||
                                  fabs(c->y) > fmax(most_px, errors * c->y_err));
}

/* Return the median absolute deviation that the error of a median came from. */
static double deviation(double err, int64_t n) {
    return err * sqrt((double)n) / of_median;
}

/* Light that was found by chance lies anywhere within REACH: its deviation is half of that. Of
 * galaxies, however faint, it is some tenths of a pixel. */
static bool is_scattered(const shear_centring *c) {
    return c->found >= FEWEST_FOUND && deviation(c->x_err, c->found) > scattered_px &&
           deviation(c->y_err, c->found) > scattered_px;
}

bool shear_centring_is_lost(const shear_centring *c) {
    return c->looked_at >= FEWEST && (RARE * c->found < c->looked_at || is_scattered(c));
}
