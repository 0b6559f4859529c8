/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Half-light radii: of Gaussians, and of the stars that a catalog leaves out. */
#include "survey/half_light.h"
#include "test.h"

#include <math.h>

enum { NX = 60, NY = 52, SOURCES = 400 };

static double image[NX * NY];
static double r_gal[SOURCES];
static uint8_t selected[SOURCES];

static void draw(double sigma, double x0, double y0, double flux) {
    for (int k = 0; k < NX * NY; k++) {
        const double x = k % NX - x0;
        const double y = k / NX - y0; /* NOLINT(bugprone-integer-division) */
        image[k] = flux * exp(-0.5 * (x * x + y * y) / (sigma * sigma));
    }
}

static void test_gaussians(void **state) {
    (void)state;
    for (int i = 0; i < 20; i++) {
        const double sigma = 1.5 + 0.2 * i;
        draw(sigma, 29.0 + 0.1 * i, 26.0 - 0.13 * i, 10.0 * (i + 1));
        const double r = half_light_of_image(image, NX, NY);
        if (!(fabs(r / (sigma * sqrt(2.0 * log(2.0))) - 1.0) < 0.02))
            fail_msg("%g for a sigma of %g", r, sigma);
    }
}

static void test_no_light(void **state) {
    (void)state;
    for (int k = 0; k < NX * NY; k++)
        image[k] = 0.0;
    assert_true(isnan(half_light_of_image(image, NX, NY)));
    image[7] = -1.0;
    assert_true(isnan(half_light_of_image(image, NX, NY)));
    image[7] = NAN;
    assert_true(isnan(half_light_of_image(image, NX, NY)));
}

/* A catalog of `stars` that are not selected, of FLUX_RADIUS 2 and more by up to `spread`, then of
 * galaxies of `smallest` and more. */
static source_list catalog(int stars, double spread, double smallest) {
    for (int i = 0; i < SOURCES; i++) {
        const double part = i % 37 / 37.0;
        selected[i] = i >= stars;
        r_gal[i] = 2.0 * (i < stars ? 2.0 + spread * part : smallest + part);
    }
    return (source_list){
        .n = SOURCES, .r_gal = r_gal, .r_gal_measured = true, .selected = selected};
}

static void test_stars(void **state) {
    (void)state;
    source_list s = catalog(100, 0.1, 2.6);
    const double r = half_light_of_stars(&s);
    assert_true(r > 2.0 && r < 2.05);
    r_gal[3] = NAN; /* undefined, and a saturated star */
    r_gal[4] = 40.0;
    assert_true(fabs(half_light_of_stars(&s) - r) < 0.01);
    s.r_gal_measured = false;
    assert_true(isnan(half_light_of_stars(&s)));
    s.r_gal = NULL;
    assert_true(isnan(half_light_of_stars(&s)));
}

/* What is left out need not be stars. */
static void test_stars_that_are_not_known(void **state) {
    (void)state;
    source_list s = catalog(19, 0.1, 2.6); /* too few */
    assert_true(isnan(half_light_of_stars(&s)));
    s = catalog(100, 0.9, 2.95); /* small, but of all sizes */
    assert_true(isnan(half_light_of_stars(&s)));
    s = catalog(100, 0.1, 1.7); /* as large as what is selected */
    assert_true(isnan(half_light_of_stars(&s)));
    s = catalog(SOURCES, 0.1, 2.6); /* nothing is selected */
    assert_true(isnan(half_light_of_stars(&s)));
    s.n = 0;
    assert_true(isnan(half_light_of_stars(&s)));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gaussians),
        cmocka_unit_test(test_no_light),
        cmocka_unit_test(test_stars),
        cmocka_unit_test(test_stars_that_are_not_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
