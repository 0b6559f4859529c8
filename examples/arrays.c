/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measure stamps in memory: simulate sheared galaxies, and get their shear in one call. */
#include <math.h>
#include <shear.h>
#include <stdio.h>
#include <stdlib.h>

enum { GALAXIES = 2000, SIDE = 48, PIXELS = SIDE * SIDE };
static const double pi = 3.14159265358979323846;
static const double psf_px = 1.5; /* standard deviation of the Gaussian PSF */
static const double true_g1 = 0.02, true_g2 = -0.01;

/* Return a number between 0 and 1, by a linear congruential generator. */
static double uniform(void) {
    static uint64_t state = 2026;
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return ((double)(state >> 32) + 0.5) / 4294967296.0;
}

static double normal(void) {
    return sqrt(-2.0 * log(uniform())) * cos(2.0 * pi * uniform());
}

/* Draw a Gaussian of covariance [xx xy; xy yy] at the centre of the stamp, and noise of variance 1.
 */
static void draw(float *stamp, double flux, double xx, double xy, double yy) {
    const double det = xx * yy - xy * xy;
    for (int i = 0; i < PIXELS; i++) {
        const double x = i % SIDE - 0.5 * (SIDE - 1);
        const double y = i / SIDE - 0.5 * (SIDE - 1);
        const double r2 = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / det;
        stamp[i] = (float)(flux / (2.0 * pi * sqrt(det)) * exp(-0.5 * r2) + normal());
    }
}

/* Draw a galaxy with a random axis ratio and direction, sheared by (g1, g2), convolved with the
 * PSF. */
static void draw_galaxy(float *stamp) {
    const double size2 = 2.0 + 4.0 * uniform();
    const double e = 0.5 * uniform(), angle = pi * uniform();
    const double a = size2 * (1.0 + e * cos(2.0 * angle)), b = size2 * e * sin(2.0 * angle);
    const double c = size2 * (1.0 - e * cos(2.0 * angle));
    const double p = 1.0 + true_g1, q = true_g2, r = 1.0 - true_g1; /* x -> [p q; q r] x */
    draw(stamp, 3000.0, p * p * a + 2.0 * p * q * b + q * q * c + psf_px * psf_px,
         p * q * a + (p * r + q * q) * b + q * r * c,
         q * q * a + 2.0 * q * r * b + r * r * c + psf_px * psf_px);
}

int main(void) {
    float *galaxy = malloc(sizeof *galaxy * GALAXIES * PIXELS);
    float *noise = malloc(sizeof *noise * GALAXIES * PIXELS);
    static double psf[PIXELS];
    if (galaxy == NULL || noise == NULL)
        return EXIT_FAILURE;
    for (size_t i = 0; i < GALAXIES; i++) {
        draw_galaxy(galaxy + i * PIXELS);
        draw(noise + i * PIXELS, 0.0, 1.0, 0.0, 1.0);
    }
    for (int i = 0; i < PIXELS; i++) {
        const double x = i % SIDE - SIDE / 2, y = i / SIDE - SIDE / 2;
        psf[i] = exp(-0.5 * (x * x + y * y) / (psf_px * psf_px));
    }

    /* Contiguous arrays need no strides; strides of NumPy can be used as they are. */
    const shear_arrays arrays = {
        .n_stamps = GALAXIES,
        .geometry = {.nx = SIDE, .ny = SIDE, .psf_nx = SIDE, .psf_ny = SIDE, .psf_oversample = 1},
        .galaxy = {.pixels = galaxy, .type = SHEAR_PIXEL_FLOAT},
        .noise = {.pixels = noise, .type = SHEAR_PIXEL_FLOAT},
        .psf = {.pixels = psf, .type = SHEAR_PIXEL_DOUBLE}};
    shear_result result;
    shear_error err;
    if (shear_measure_arrays(&result, &arrays, NULL, NULL, &err) != SHEAR_OK) {
        fprintf(stderr, "%s (%s)\n", err.message, err.advice);
        return EXIT_FAILURE;
    }
    printf("g1 = %+.5f +- %.5f, true %+.3f\n", result.g1, result.g1_err, true_g1);
    printf("g2 = %+.5f +- %.5f, true %+.3f\n", result.g2, result.g2_err, true_g2);
    free(galaxy);
    free(noise);
    return EXIT_SUCCESS;
}
