/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fast tests come first: the extremes of the pixels, which the photometry has anyway, and, if a
 * strip of columns has a bright pixel, a scan of the strip with the smallest threshold possible.
 * Only a stamp that remains suspect is tested pixel by pixel. */
#include "measure/artefact.h"

#include "base/simd.h"
#include "base/sort.h"
#include "shear/stamp.h"

#include <math.h>

/* Of p - r m: 3e-7 false alarms in 64 x 64 px of white noise. */
static const double bright_sigma = 6.5;
static const double dark_sigma = 6.6;     /* 2e-7, likewise */
static const double part_of_pixel = 0.03; /* relative error of a PSF image that is tolerated */
static const double part_of_peak = 1e-3;  /* rounding and periodicity in faint places */
/* Of the peak: negative wings from interpolation or aliasing. */
static const double dark_part = 0.01;
static const double sky_electrons = 5.0; /* the smallest noise of a pixel that is assumed */
static const double sigma_of_mad = 1.4826;

static double white_gain(double ratio) {
    return sqrt(1.0 + 0.5 * ratio * ratio);
}

/* Largest ratio of a border pixel to the pixel inside it, q: that of a Gaussian whose centre is 1.5
 * px outside, which is more than a Moffat's anywhere. */
static double steepest(double ratio) {
    return ratio * fmax(4.0, ratio * ratio * ratio);
}

/* Return the noise of p - steepest q over that of p - r m, computed with half of `steepest`: the
 * light of a PSF is no steeper than that, so the other half leaves a margin. */
static double gain_at_border(double ratio) {
    return hypot(1.0, 0.5 * steepest(ratio)) / white_gain(ratio);
}

/* Across the border there is no mean. Return the pixel inside it, in a corner the darker of the
 * two; INFINITY if (x, y) is not a border pixel. */
static double inside_border(const double *pixels, int nx, int ny, int x, int y) {
    const double *p = pixels + (size_t)y * (size_t)nx + (size_t)x;
    const double row = x == 0 ? p[1] : x == nx - 1 ? p[-1] : INFINITY;
    const double column = y == 0 ? p[nx] : y == ny - 1 ? p[-nx] : INFINITY;
    return row < column ? row : column;
}

static double median(double *values, size_t n) {
    sort_doubles(values, n);
    return values[n / 2];
}

size_t artefact_border(const double *pixels, int nx, int ny, double *values) {
    size_t n = 0;
    for (int x = 0; x < nx; x++) {
        values[n++] = pixels[x];
        values[n++] = pixels[(size_t)(ny - 1) * (size_t)nx + (size_t)x];
    }
    for (int y = 1; y < ny - 1; y++) {
        values[n++] = pixels[(size_t)y * (size_t)nx];
        values[n++] = pixels[(size_t)(y + 1) * (size_t)nx - 1];
    }
    return n;
}

/* Set *middle to the median of the one-pixel border, and *sigma to the noise that corresponds to
 * the median deviation from it. */
static void look_at_border(const double *pixels, int nx, int ny, double *middle, double *sigma) {
    double values[4 * SHEAR_MAX_SIDE];
    const size_t n = artefact_border(pixels, nx, ny, values);
    *middle = median(values, n);
    for (size_t i = 0; i < n; i++)
        values[i] = fabs(values[i] - *middle);
    *sigma = sigma_of_mad * median(values, n);
}

double artefact_sigma(const artefact_pair *pair) {
    static const double rounding = 1e-9;
    const photometry *ph = pair->ph;
    const double n = (double)pair->nx * pair->ny;
    const double far = fmax(ph->noise_most - ph->noise_mean, ph->noise_mean - ph->noise_least);
    const double squares = n * ph->noise_var - far * far * n / (n - 1.0);
    if (squares > rounding * far * far || far == 0.0)
        return sqrt(fmax(0.0, squares) / (n - 1.0));
    double middle;
    double sigma;
    look_at_border(pair->noise, pair->nx, pair->ny, &middle, &sigma);
    return sigma;
}

/* Return the brightest pixel of n rows of a strip. */
static SHEAR_INLINE double brightest(const double *rows, size_t nx, size_t n) {
    double best[FFT_LANES];
    for (size_t l = 0; l < FFT_LANES; l++)
        best[l] = rows[l];
    for (size_t y = 1; y < n; y++) {
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++)
            best[l] = rows[y * nx + l] > best[l] ? rows[y * nx + l] : best[l];
    }
    return fft_largest(best);
}

/* Return the largest (1 - part_of_pixel) p - r max(m, sky) of n rows of a strip, none of them the
 * stamp's first or last. Next to the left and right border, a pixel of another row serves as the
 * neighbour; if that is wrong, m is too small. */
static SHEAR_INLINE double most_over_mean(const double *rows, size_t nx, size_t n, double r,
                                          double sky) {
    const double own = 1.0 - part_of_pixel;
    double best[FFT_LANES];
    for (size_t l = 0; l < FFT_LANES; l++)
        best[l] = -INFINITY;
    for (size_t y = 0; y < n; y++) {
        const double *row = rows + y * nx;
        const double *below = row - nx;
        const double *above = row + nx;
        const double *left = row - 1;
        const double *right = row + 1;
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++) {
            const double along = left[l] + right[l];
            const double across = below[l] + above[l];
            const double mean = 0.5 * (along < across ? along : across);
            const double p = own * row[l] - r * (mean > sky ? mean : sky);
            best[l] = p > best[l] ? p : best[l];
        }
    }
    return fft_largest(best);
}

/* Return the largest (1 - part_of_pixel) p - r m of a strip, p and m above the sky. Only rows near
 * a pixel brighter than `bright` are read. */
SHEAR_SIMD static double stand_out(const double *strip, size_t nx, size_t ny, double r, double sky,
                                   double bright) {
    enum { ROWS = 8 };
    double most = -INFINITY;
    for (size_t y = 1; y + 1 < ny; y += ROWS) {
        const double *rows = strip + y * nx;
        const size_t n = ny - 1 - y < ROWS ? ny - 1 - y : ROWS;
        if (brightest(rows, nx, n) > bright) {
            const double found = most_over_mean(rows, nx, n, r, sky);
            most = found > most ? found : most;
        }
    }
    return most + (r - (1.0 - part_of_pixel)) * sky;
}

/* Return whether border pixel (x, y) is too bright relative to its neighbours along the border
 * (threshold `bright`) or to the pixel inside it. */
static bool border_pixel_stands_out(const artefact_pair *pair, int x, int y, double r,
                                    double bright) {
    const double sky = pair->ph->noise_mean;
    const double *row = pair->galaxy + (size_t)y * (size_t)pair->nx;
    if (!(row[x] - sky > bright))
        return false;
    const double p = (1.0 - part_of_pixel) * (row[x] - sky);
    const bool side = x == 0 || x == pair->nx - 1;
    const double m = side ? INFINITY : 0.5 * (row[x - 1] + row[x + 1]) - sky;
    const double q = inside_border(pair->galaxy, pair->nx, pair->ny, x, y) - sky;
    return p - r * fmax(0.0, m) > bright ||
           p - steepest(r) * fmax(0.0, q) > bright * gain_at_border(r);
}

/* Return whether a border pixel in columns [x0, x0 + FFT_LANES) is too bright. */
static bool border_stands_out(const artefact_pair *pair, int x0, double r, double bright) {
    const int last = pair->nx - 1;
    bool found = false;
    for (int x = x0; x < x0 + FFT_LANES; x++) {
        found = found || border_pixel_stands_out(pair, x, 0, r, bright) ||
                border_pixel_stands_out(pair, x, pair->ny - 1, r, bright);
    }
    for (int y = 1; y < pair->ny - 1 && (x0 == 0 || x0 + FFT_LANES > last); y++) {
        found = found || (x0 == 0 && border_pixel_stands_out(pair, 0, y, r, bright)) ||
                (x0 + FFT_LANES > last && border_pixel_stands_out(pair, last, y, r, bright));
    }
    return found;
}

int artefact_strip_start(const artefact_pair *pair, int i) {
    const int last = pair->nx - FFT_LANES;
    return i * FFT_LANES < last ? i * FFT_LANES : last;
}

bool artefact_suspected(const artefact_pair *pair, const sharpness *s) {
    const photometry *ph = pair->ph;
    const double sigma = artefact_sigma(pair);
    if (!(sigma > 0.0))
        return false;
    const double sky = ph->noise_mean;
    const double bright = bright_sigma * white_gain(s->ratio) * sigma;
    const double dark = sky - dark_sigma * sigma;
    bool suspected =
        ph->galaxy_least < dark || ph->noise_least < dark || ph->noise_most > sky + bright;
    for (int i = 0; i * FFT_LANES < pair->nx && !suspected; i++) {
        if (pair->strip_most[i] > sky + bright) {
            const int x0 = artefact_strip_start(pair, i);
            suspected = stand_out(pair->galaxy + x0, (size_t)pair->nx, (size_t)pair->ny, s->ratio,
                                  sky, sky + bright) > bright ||
                        border_stands_out(pair, x0, s->ratio, bright);
        }
    }
    return suspected;
}

/* ---- pixel by pixel ---- */

/* An image, and the limits for its pixels. */
typedef struct stamp_test {
    const double *pixels;
    int nx, ny;
    double ratio;
    double sky, low_sky; /* of the noise stamp; low_sky: of the image's border, if that is less */
    double sigma, gain;  /* gain: noise of p - r m over that of a pixel */
    double allowance;    /* the part that scales with neither noise nor pixel */
    double dark;         /* the lowest value allowed */
} stamp_test;

static double pixel(const stamp_test *t, int x, int y) {
    return t->pixels[(size_t)y * (size_t)t->nx + (size_t)x];
}

/* Return the smaller of the two means; INFINITY in a corner. */
static double around(const stamp_test *t, int x, int y) {
    const bool inside_x = x > 0 && x < t->nx - 1;
    const bool inside_y = y > 0 && y < t->ny - 1;
    const double row = inside_x ? 0.5 * (pixel(t, x - 1, y) + pixel(t, x + 1, y)) : INFINITY;
    const double column = inside_y ? 0.5 * (pixel(t, x, y - 1) + pixel(t, x, y + 1)) : INFINITY;
    return fmin(row, column);
}

/* Return by how much a pixel is brighter than m allows. sigma: the noise of their difference. */
static double too_bright(const stamp_test *t, double p, double m, double sigma) {
    const double bright =
        (1.0 - part_of_pixel) * (p - t->sky) - m - bright_sigma * sigma - t->allowance;
    return isnan(bright) ? -INFINITY : bright;
}

/* Return by how much pixel (x, y) is too bright or too dark; <= 0: it is neither. */
static double excess(const stamp_test *t, int x, int y) {
    const double p = pixel(t, x, y);
    const double m = t->ratio * fmax(0.0, around(t, x, y) - t->low_sky);
    const double photons = sqrt(1.0 + m / (sky_electrons * t->sigma));
    const double sigma = t->gain * t->sigma;
    double most = fmax(too_bright(t, p, m, sigma * photons), t->dark - p);
    const double inside = inside_border(t->pixels, t->nx, t->ny, x, y);
    if (isfinite(inside)) {
        const double q = steepest(t->ratio) * fmax(0.0, inside - t->low_sky);
        most = fmax(most, too_bright(t, p, q, sigma * gain_at_border(t->ratio)));
    }
    return most;
}

/* Return the larger scatter of p - r m, along rows or columns, over that of the pixels, inside an
 * image. */
static double measured_gain(const double *pixels, int nx, int ny, double sky, double r) {
    double own = 0.0;
    double rows = 0.0;
    double columns = 0.0;
    for (int y = 1; y < ny - 1; y++) {
        for (int x = 1; x < nx - 1; x++) {
            const double *p = pixels + (size_t)y * (size_t)nx + (size_t)x;
            const double here = *p - sky;
            const double row = here - r * (0.5 * (p[-1] + p[1]) - sky);
            const double column = here - r * (0.5 * (p[-nx] + p[nx]) - sky);
            own += here * here;
            rows += row * row;
            columns += column * column;
        }
    }
    return sqrt(fmax(rows, columns) / own);
}

/* Return the gain. Noise that is sharper than white makes p - r m scatter more; softer noise is
 * treated as white. */
static double gain_of(const artefact_pair *pair, double ratio) {
    const double gain = measured_gain(pair->noise, pair->nx, pair->ny, pair->ph->noise_mean, ratio);
    return fmax(white_gain(ratio), isfinite(gain) ? gain : 0.0);
}

static stamp_test stamp_test_of(const artefact_pair *pair, const double *pixels, const sharpness *s,
                                double most, double flux) {
    const double sky = pair->ph->noise_mean;
    const double peak = fmax(0.0, most - sky);
    double middle;
    double scatter;
    stamp_test j = {
        .pixels = pixels, .nx = pair->nx, .ny = pair->ny, .ratio = s->ratio, .sky = sky};
    look_at_border(pixels, pair->nx, pair->ny, &middle, &scatter);
    j.low_sky = fmin(sky, middle);
    j.sigma = fmax(artefact_sigma(pair), scatter);
    j.gain = gain_of(pair, s->ratio);
    j.allowance = s->leak * fmax(0.0, flux) + part_of_peak * peak;
    j.dark = j.low_sky - dark_sigma * j.sigma - dark_part * peak;
    return j;
}

static artefact worst_of(const stamp_test *t) {
    artefact worst = {.x = -1, .y = -1};
    double most = 0.0;
    for (int y = 0; y < t->ny; y++) {
        for (int x = 0; x < t->nx; x++) {
            const double e = excess(t, x, y);
            if (e > most) {
                most = e;
                worst = (artefact){.x = x, .y = y};
            }
        }
    }
    return worst;
}

artefact artefact_find(const artefact_pair *pair, const sharpness *s) {
    const photometry *ph = pair->ph;
    const stamp_test galaxy = stamp_test_of(pair, pair->galaxy, s, ph->galaxy_most, ph->flux);
    artefact worst = worst_of(&galaxy);
    if (worst.x < 0) {
        const stamp_test noise = stamp_test_of(pair, pair->noise, s, ph->noise_most, 0.0);
        worst = worst_of(&noise);
        worst.in_noise = worst.x >= 0;
    }
    return worst;
}
