/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/reach.h"

#include "base/arena.h"
#include "base/simd.h"
#include "base/sort.h"
#include "measure/radial.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of every 64 stamps the brightest is dropped, and the extremes of each ring, so that no star or
 * artefact decides. */
enum { TRIMMED = 64, FEWEST = 64, CORES_PER_PX = 4 };

/* Fraction of the shear that the mean profile may lose. The moments are quadratic in the flux:
 * large and elongated galaxies lose more, up to 10 times as much (docs/method.md, section 2). */
static const double most_lost = 1e-4;
/* A ring this many errors above zero is detected ... */
static const double seen = 4.0;
/* ... and beyond the last one the profile continues as exp(-b sqrt(r)), between a disk's and a
 * bulge's; there it falls at least like this power of the radius. */
static const double slowest_fall = 2.5;

static void measure_rings(reach *r) {
    for (int y = 0; y < r->ny; y++) {
        for (int x = 0; x < r->nx; x++) {
            const double d = hypot(x - 0.5 * (r->nx - 1), y - 0.5 * (r->ny - 1));
            const int ring = d < r->n_rings ? (int)d : -1;
            r->ring[y * r->nx + x] = ring;
            if (ring >= 0) {
                r->pixels[ring] += 1.0;
                r->radius[ring] += d;
            }
        }
    }
    for (int i = 0; i < r->n_rings; i++)
        r->radius[i] = r->pixels[i] > 0.0 ? r->radius[i] / r->pixels[i] : i + 0.5;
}

static void place(reach *r, arena *a) {
    const size_t rings = (size_t)r->n_rings;
    r->ring = arena_take(a, (size_t)r->nx * (size_t)r->ny * sizeof *r->ring);
    r->pixels = arena_doubles(a, rings);
    r->radius = arena_doubles(a, rings);
    r->mean = arena_doubles(a, (size_t)r->capacity * rings);
    r->sorted = arena_doubles(a, (size_t)r->capacity);
    r->profile = arena_doubles(a, rings);
}

bool reach_init(reach *r, int nx, int ny, int capacity) {
    *r = (reach){.nx = nx, .ny = ny, .n_rings = (nx < ny ? nx : ny) / 2, .capacity = capacity};
    arena a = {0};
    place(r, &a);
    r->memory = arena_allocate(&a);
    if (r->memory == NULL)
        return false;
    place(r, &a);
    measure_rings(r);
    return true;
}

void reach_deinit(reach *r) {
    free(r->memory);
    *r = (reach){0};
}

/* Return the mean; not finite if a pixel is not. */
SHEAR_SIMD static double mean_of(const double *pixel, int n) {
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (int i = 0; i < n; i++)
        sum += pixel[i];
    return sum / n;
}

void reach_add(reach *r, const double *galaxy, const double *noise) {
    const int pixels = r->nx * r->ny;
    double *mean = r->mean + (size_t)r->count * (size_t)r->n_rings;
    const double level = mean_of(noise, pixels);
    if (r->count == r->capacity || !isfinite(level) || !isfinite(mean_of(galaxy, pixels)))
        return;
    memset(mean, 0, (size_t)r->n_rings * sizeof *mean);
    for (int i = 0; i < pixels; i++) {
        if (r->ring[i] >= 0)
            mean[r->ring[i]] += galaxy[i];
    }
    for (int i = 0; i < r->n_rings; i++)
        mean[i] = r->pixels[i] > 0.0 ? mean[i] / r->pixels[i] - level : 0.0;
    r->count++;
}

/* ---- the stack ---- */

static double flux_within(const reach *r, int stamp, double radius) {
    const double *mean = r->mean + (size_t)stamp * (size_t)r->n_rings;
    double flux = 0.0;
    for (int i = 0; i < r->n_rings && r->radius[i] < radius; i++)
        flux += r->pixels[i] * mean[i];
    return flux;
}

/* Weight every ring by its stamp's flux, as the moments do. A stamp with a negative flux gets
 * weight 0; the brightest are removed. Return how many stamps are left. */
static int weigh(reach *r, double aperture) {
    for (int s = 0; s < r->count; s++)
        r->sorted[s] = flux_within(r, s, aperture);
    sort_doubles(r->sorted, (size_t)r->count);
    const double brightest = r->sorted[r->count - 1 - r->count / TRIMMED];
    int left = 0;
    for (int s = 0; s < r->count; s++) {
        const double flux = flux_within(r, s, aperture);
        if (flux > brightest)
            continue;
        for (int i = 0; i < r->n_rings; i++) {
            const double value = r->mean[(size_t)s * (size_t)r->n_rings + (size_t)i];
            r->mean[(size_t)left * (size_t)r->n_rings + (size_t)i] = fmax(flux, 0.0) * value;
        }
        left++;
    }
    r->count = left;
    return left;
}

/* Return the trimmed mean of ring i, and its error. */
static double ring_mean(reach *r, int i, double *error) {
    const int n = r->count;
    const int cut = n / TRIMMED;
    double sum = 0.0;
    double squares = 0.0;
    for (int s = 0; s < n; s++)
        r->sorted[s] = r->mean[(size_t)s * (size_t)r->n_rings + (size_t)i];
    sort_doubles(r->sorted, (size_t)n);
    for (int s = cut; s < n - cut; s++)
        sum += r->sorted[s];
    const double mean = sum / (n - 2 * cut);
    for (int s = 0; s < n; s++) {
        const int kept = s < cut ? cut : s < n - cut ? s : n - cut - 1;
        squares += (r->sorted[kept] - mean) * (r->sorted[kept] - mean);
    }
    *error = sqrt(squares) / n;
    return mean;
}

/* Fill the profile. Return the last ring that is detected without a gap, or -1. */
static int stack(reach *r) {
    int last = -1;
    for (int i = 0; i < r->n_rings; i++) {
        double error;
        r->profile[i] = ring_mean(r, i, &error);
        if (last == i - 1 && r->profile[i] > seen * error && r->profile[i] > 0.0)
            last = i;
    }
    return last;
}

/* ---- the core ---- */

/* Return the profile at any radius: as measured, then extrapolated with the slope of the last 40 %
 * of it. */
static double profile_at(const reach *r, int last, double fall, double radius) {
    assert(last >= 0 && last < r->n_rings);
    if (radius >= r->radius[last])
        return r->profile[last] * exp(fall * (sqrt(r->radius[last]) - sqrt(radius)));
    int i = 0;
    while (r->radius[i + 1] <= radius)
        i++;
    if (radius <= r->radius[0])
        return r->profile[0];
    const double x = (radius - r->radius[i]) / (r->radius[i + 1] - r->radius[i]);
    return r->profile[i] + x * (r->profile[i + 1] - r->profile[i]);
}

static void load(const reach *r, int last, radial *q) {
    const int from = (int)(0.6 * last);
    const double at = sqrt(r->radius[last]);
    const double fall = log(r->profile[from] / r->profile[last]) / (at - sqrt(r->radius[from]));
    for (int i = 0; i < q->n_r; i++)
        q->profile[i] = profile_at(r, last, fmax(fall, 2.0 * slowest_fall / at), q->r[i]);
    radial_load(q);
}

static bool whole(radial *q, int quarters, double width) {
    return fabs(radial_response(q, (double)quarters / CORES_PER_PX, width) - 1.0) < most_lost;
}

/* Find it by bisection: a wider core loses less. */
static double smallest_core(const reach *r, radial *q, double beta, double width) {
    const int side = r->nx < r->ny ? r->nx : r->ny;
    int low = (int)ceil(2.0 * beta * CORES_PER_PX);
    int high = (side - 1) * CORES_PER_PX / 2;
    if (low > high || !whole(q, high, width))
        return NAN;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (whole(q, middle, width)) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return (double)high / CORES_PER_PX;
}

bool reach_core(reach *r, double r_psf, double beta, double width, double *core) {
    *core = NAN;
    const int last = r->count < FEWEST || weigh(r, 2.0 * beta) < FEWEST ? -1 : stack(r);
    if (last < 3)
        return true;
    radial q;
    const bool made = radial_init(&q, 0.7 * (r->nx > r->ny ? r->nx : r->ny), r_psf, beta);
    if (made) {
        load(r, last, &q);
        *core = smallest_core(r, &q, beta, width);
    }
    radial_deinit(&q);
    return made;
}
