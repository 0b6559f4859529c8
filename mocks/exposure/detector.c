/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "exposure/detector.h"

#include "base/cleanup.h"
#include "random.h"

#include <gsl/gsl_math.h>
#include <gsl/gsl_randist.h>
#include <math.h>

static const double hot_column = 5000.0; /* ADU above the background */
static const double cosmic_min = 500.0;  /* ADU; of a track's pixels */
static const double cosmic_max = 20000.0;
enum { COSMIC_MAX_LENGTH = 25 };

double detector_variance(const shear_mock_exposure *e, double light) {
    const double read = e->read_noise / e->gain;
    return (e->sky + fmax(0.0, light)) / e->gain + read * read;
}

/* Fill row[nx + 2] with Gaussian random numbers: those of image row y, from column -1 on. */
static void draw_row(const shear_mock_exposure *e, int chip, int y, double *row) {
    random_sequence r;
    random_begin(&r, e->seed, RANDOM_EXPOSURE_NOISE, (uint64_t)chip, (uint64_t)y + 1);
    for (int x = 0; x < e->nx + 2; x++)
        row[x] = gsl_ran_gaussian_ziggurat(&r.rng, 1.0);
}

/* Correlate the middle one of three rows with its neighbours: (a, 1, a) along x and along y, whose
 * correlation is 2 a / (1 + 2 a^2). */
static void correlate(const shear_mock_exposure *e, const double *rows, double *out) {
    const int stride = e->nx + 2;
    const double rho = e->correlation;
    const double a = (1.0 - sqrt(1.0 - 2.0 * rho * rho)) / (2.0 * rho);
    const double norm = 1.0 / (1.0 + 2.0 * a * a);
    for (int x = 0; x < e->nx; x++) {
        double sum = 0.0;
        for (int k = 0; k < 3; k++) {
            const double *p = rows + (ptrdiff_t)k * stride + x;
            sum += (k == 1 ? 1.0 : a) * (a * p[0] + p[1] + a * p[2]);
        }
        out[x] = norm * sum;
    }
}

/* Compute the noise of row y, standard deviation 1: out[nx]; rows[3][nx + 2] is scratch memory. */
static void noise_row(const shear_mock_exposure *e, int chip, int y, double *rows, double *out) {
    const int stride = e->nx + 2;
    if (e->correlation > 0.0) {
        for (int k = 0; k < 3; k++)
            draw_row(e, chip, y + k - 1, rows + (ptrdiff_t)k * stride);
        correlate(e, rows, out);
        return;
    }
    draw_row(e, chip, y, rows);
    memcpy(out, rows + 1, (size_t)e->nx * sizeof *out);
}

static bool add_noise(const shear_mock_exposure *e, int chip, int threads, double *image) {
    const size_t stride = (size_t)e->nx + 2;
    bool failed = false;
#pragma omp parallel num_threads(threads) reduction(|| : failed)
    {
        CLEANUP(release_free) double *rows = calloc(4 * stride, sizeof *rows);
        failed = rows == NULL;
#pragma omp for
        for (int y = 0; y < e->ny; y++) {
            double *pixels = image + (ptrdiff_t)y * e->nx;
            if (failed)
                continue;
            double *noise = rows + 3 * stride;
            noise_row(e, chip, y, rows, noise);
            for (int x = 0; x < e->nx; x++) {
                const double light = e->source_noise ? pixels[x] : 0.0;
                pixels[x] += e->sky + sqrt(detector_variance(e, light)) * noise[x];
            }
        }
    }
    return !failed;
}

static void add_cosmic_rays(const shear_mock_exposure *e, int chip, double *image, uint8_t *mask) {
    random_sequence r;
    for (int i = 0; i < e->cosmic_rays; i++) {
        random_begin(&r, e->seed, RANDOM_EXPOSURE_COSMICS, (uint64_t)chip, (uint64_t)i);
        const double x0 = e->nx * gsl_rng_uniform(&r.rng);
        const double y0 = e->ny * gsl_rng_uniform(&r.rng);
        const double angle = 2.0 * M_PI * gsl_rng_uniform(&r.rng);
        const double length = 1.0 + COSMIC_MAX_LENGTH * gsl_rng_uniform(&r.rng);
        for (int k = 0; k < (int)length; k++) {
            const int x = (int)floor(x0 + k * cos(angle));
            const int y = (int)floor(y0 + k * sin(angle));
            const double u = gsl_rng_uniform(&r.rng);
            if (x < 0 || y < 0 || x >= e->nx || y >= e->ny)
                continue;
            image[(ptrdiff_t)y * e->nx + x] += cosmic_min * pow(cosmic_max / cosmic_min, u);
            mask[(ptrdiff_t)y * e->nx + x] |= DETECTOR_COSMIC;
        }
    }
}

/* Half of the bad columns are dead, half are hot. */
static void add_bad_columns(const shear_mock_exposure *e, int chip, double *image, uint8_t *mask) {
    random_sequence r;
    random_begin(&r, e->seed, RANDOM_EXPOSURE_COLUMNS, (uint64_t)chip, 0);
    for (int i = 0; i < e->bad_columns; i++) {
        const ptrdiff_t x = (ptrdiff_t)(e->nx * gsl_rng_uniform(&r.rng));
        for (ptrdiff_t y = 0; y < e->ny; y++) {
            image[y * e->nx + x] = i % 2 == 0 ? 0.0 : e->sky + hot_column;
            mask[y * e->nx + x] |= DETECTOR_COLUMN;
        }
    }
}

static void saturate(const shear_mock_exposure *e, double *image, uint8_t *mask) {
    const ptrdiff_t n = (ptrdiff_t)e->nx * e->ny;
    for (ptrdiff_t i = 0; i < n; i++) {
        if (image[i] < e->saturation)
            continue;
        image[i] = e->saturation;
        mask[i] |= DETECTOR_SATURATED;
    }
}

bool detector_expose(const shear_mock_exposure *e, int chip, int threads, double *image,
                     uint8_t *mask) {
    memset(mask, 0, (size_t)e->nx * (size_t)e->ny);
    if (!add_noise(e, chip, threads, image))
        return false;
    add_cosmic_rays(e, chip, image, mask);
    add_bad_columns(e, chip, image, mask);
    saturate(e, image, mask);
    return true;
}
