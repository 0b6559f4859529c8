/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The three noises against their statistics. Tolerances are 4 to 5 standard errors, for fixed
 * seeds. */
#include "test_mock_fixture.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_math.h>
#include <math.h>
#include <stdlib.h>

enum { SIDE = 32, PIXELS = SIDE * SIDE };

static double *noise_stamps(const shear_mock *m, int count) {
    double *galaxy, *noise;
    make_stamps(m, 0, count, 0, &galaxy, &noise);
    free(galaxy);
    return noise;
}

#define SMALL "size", "32", "r-gal", "4", "r-psf", "0.5"

/* A Poisson field of points: mean n A S, variance n A^2 int W^2; for W_A int W^2 = S / 2. */
static void test_sources(void **state) {
    (void)state;
    enum { COUNT = 60 };
    shear_mock *m = MOCK(SMALL, "noise-ratio", "0.5", "noise-density", "2");
    const shear_mock_info *info = shear_mock_get_info(m);
    double s = 2.0 * M_PI * 0.25 / sqrt(0.8);
    double mean = 0.5 * 600.0 * s / (M_PI * 16.0); /* half of the galaxy's mean flux density */
    double a = mean / (2.0 * s);
    double variance = 2.0 * a * a * s / 2.0;
    double *noise = noise_stamps(m, COUNT);
    size_t n = (size_t)COUNT * PIXELS;
    /* Pixels within a PSF are correlated: the number of independent ones is the area over that of W
     * * W. */
    double independent = (double)n / (4.0 * M_PI * 0.25 / sqrt(0.8));
    assert_close(info->noise_density, 2.0, 0.0);
    assert_close(info->noise_amplitude, a, 1e-12 * a);
    assert_close(mean_of(noise, n), mean, 5.0 * sqrt(variance / independent));
    assert_close(variance_of(noise, n) / variance, 1.0, 5.0 * sqrt(2.5 / independent));
    free(noise);
    shear_mock_free(m);
}

/* Sources around the stamp shine in: the border is as bright as the middle. */
static void test_sources_reach_over_the_border(void **state) {
    (void)state;
    enum { COUNT = 60 };
    shear_mock *m = MOCK(SMALL, "noise-ratio", "0.5");
    double *noise = noise_stamps(m, COUNT);
    double border = 0.0, middle = 0.0;
    int n_border = 0, n_middle = 0;
    for (int k = 0; k < COUNT * PIXELS; k++) {
        int i = k % SIDE;
        int j = k / SIDE % SIDE;
        bool at_border = i == 0 || j == 0 || i == SIDE - 1 || j == SIDE - 1;
        border += at_border ? noise[k] : 0.0;
        middle += at_border ? 0.0 : noise[k];
        n_border += at_border;
        n_middle += !at_border;
    }
    border /= n_border;
    middle /= n_middle;
    /* The density is 1/R^2, so that var/mean^2 = 1 / (2 n S) = 0.071; a border pixel's neighbours
     * along the border count with it: about 2.1 px of correlation. */
    double error = sqrt(0.071 * 2.1 / n_border);
    assert_close(border / middle, 1.0, 5.0 * error);
    assert_true(5.0 * error < 0.05); /* half of the light would be missing otherwise */
    free(noise);
    shear_mock_free(m);
}

/* A finite integer is its own rounding. */
static bool is_count(double x) {
    return x >= 0.0 && x == floor(x);
}

static void test_photons(void **state) {
    (void)state;
    static const char *const levels[] = {"3.5", "100"};
    for (int k = 0; k < 2; k++) {
        enum { COUNT = 60 };
        shear_mock *m = MOCK(SMALL, "photons", levels[k]);
        double *noise = noise_stamps(m, COUNT);
        size_t n = (size_t)COUNT * PIXELS;
        double level = atof(levels[k]);
        for (size_t i = 0; i < n; i++)
            assert_true(is_count(noise[i]));
        assert_close(mean_of(noise, n), level, 4.0 * sqrt(level / (double)n));
        assert_close(variance_of(noise, n) / level, 1.0,
                     4.0 * sqrt((2.0 + 1.0 / level) / (double)n));
        free(noise);
        shear_mock_free(m);
    }
}

/* The galaxy's mean surface brightness within R_G is photon_snr times the background (before the
 * lensing, which conserves it but shrinks the area by det A). */
static void test_photons_of_the_galaxy(void **state) {
    (void)state;
    enum { COUNT = 40 };
    shear_mock *m = MOCK(SMALL, "photons", "5000", "photon-snr", "0.4", "shear", "0.1,0");
    const shear_mock_info *info = shear_mock_get_info(m);
    double *galaxy, *noise;
    make_stamps(m, 0, COUNT, 0, &galaxy, &noise);
    double sky = 5000.0 * PIXELS;
    double photons = mean_of(galaxy, (size_t)COUNT * PIXELS) * PIXELS - sky;
    double before_lensing = 0.4 * 5000.0 * M_PI * 16.0;
    double expected = before_lensing * (1.0 - 0.1 * 0.1);
    double tolerance = 4.0 * sqrt((sky + expected) / COUNT);
    assert_close(600.0 * info->point_amplitude * info->psf_flux, before_lensing, 1e-9);
    assert_close(photons, expected, tolerance);
    assert_true(tolerance < 0.02 * expected);
    free(galaxy);
    free(noise);
    shear_mock_free(m);
}

static void test_background_subtracted(void **state) {
    (void)state;
    shear_mock *with = MOCK(SMALL, "photons", "12.5");
    shear_mock *without = MOCK(SMALL, "photons", "12.5", "subtract-background", "yes");
    double *kept = noise_stamps(with, 2);
    double *taken = noise_stamps(without, 2);
    for (int i = 0; i < 2 * PIXELS; i++)
        assert_true(taken[i] == kept[i] - 12.5);
    free(kept);
    free(taken);
    shear_mock_free(with);
    shear_mock_free(without);
}

/* Pixels draw from their own sequences: a galaxy in the middle does not move the counts far from
 * it. */
static void test_photons_far_from_the_galaxy(void **state) {
    (void)state;
    shear_mock *faint =
        MOCK("size", "48", "r-gal", "3", "r-psf", "0.8", "photons", "20", "photon-snr", "0.01");
    shear_mock *bright =
        MOCK("size", "48", "r-gal", "3", "r-psf", "0.8", "photons", "20", "photon-snr", "1");
    double *a, *b, *n;
    make_stamps(faint, 0, 1, 1, &a, &n);
    free(n);
    make_stamps(bright, 0, 1, 1, &b, &n);
    free(n);
    int moved = 0;
    for (int k = 0; k < 48 * 48; k++) {
        double r = hypot(k % 48 - 23.5, k / 48 - 23.5);
        assert_true(r < 15.0 || a[k] == b[k]);
        moved += a[k] != b[k];
    }
    assert_true(moved > 10);
    free(a);
    free(b);
    shear_mock_free(faint);
    shear_mock_free(bright);
}

static double gaussian_cdf(double x, void *sigma) {
    return gsl_cdf_gaussian_P(x, *(double *)sigma);
}

static void test_white(void **state) {
    (void)state;
    enum { COUNT = 30 };
    double sigma = 2.5;
    size_t n = (size_t)COUNT * PIXELS;
    shear_mock *m = MOCK(SMALL, "white", "2.5");
    double *noise = noise_stamps(m, COUNT);
    assert_close(mean_of(noise, n), 0.0, 4.0 * sigma / sqrt((double)n));
    assert_close(variance_of(noise, n) / (sigma * sigma), 1.0, 4.0 * sqrt(2.0 / (double)n));
    double neighbours = 0.0;
    for (size_t i = 1; i < n; i++)
        neighbours += noise[i] * noise[i - 1] / (sigma * sigma * (double)n);
    assert_close(neighbours, 0.0, 4.0 / sqrt((double)n));
    assert_true(ks_of(noise, n, gaussian_cdf, &sigma) < 1.95);
    free(noise);
    shear_mock_free(m);
}

static void test_default_density(void **state) {
    (void)state;
    shear_mock *m = MOCK("r-psf", "4", "noise-ratio", "1.5", "size", "256", "r-gal", "30");
    const shear_mock_info *info = shear_mock_get_info(m);
    assert_close(info->noise_density, 1.0 / 16.0, 1e-16);
    double mean = info->noise_density * info->noise_amplitude;
    assert_close(mean, 1.5 * 600.0 / (M_PI * 900.0), 1e-15);
    shear_mock_free(m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sources),
        cmocka_unit_test(test_sources_reach_over_the_border),
        cmocka_unit_test(test_photons),
        cmocka_unit_test(test_photons_of_the_galaxy),
        cmocka_unit_test(test_background_subtracted),
        cmocka_unit_test(test_photons_far_from_the_galaxy),
        cmocka_unit_test(test_white),
        cmocka_unit_test(test_default_density),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
