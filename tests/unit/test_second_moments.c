/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Adaptive moments: Gaussians of any shape and place, what has none, and other coordinates. */
#include "survey/second_moments.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

enum { NX = 48, NY = 40 };

static double image[NX * NY];

static void assert_near(double a, double b, double tolerance) {
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.12g is not %.12g within %g", a, b, tolerance);
}

static void draw(const double c[3], double x0, double y0, double flux) {
    const double det = c[0] * c[2] - c[1] * c[1];
    for (int j = 0; j < NY; j++) {
        for (int i = 0; i < NX; i++) {
            const double x = i - x0;
            const double y = j - y0;
            const double r2 = (c[2] * x * x - 2.0 * c[1] * x * y + c[0] * y * y) / det;
            image[j * NX + i] = flux * exp(-0.5 * r2);
        }
    }
}

static void test_gaussians(void **state) {
    static const double shapes[][3] = {
        {4.0, 0.0, 4.0}, {9.0, 2.0, 3.0}, {2.0, -0.9, 2.0}, {25.0, 0.0, 1.5}};
    (void)state;
    for (size_t k = 0; k < sizeof shapes / sizeof shapes[0]; k++) {
        double cov[3];
        draw(shapes[k], 23.3 - (double)k, 18.7, 3.7e4);
        assert_true(second_moments(image, NX, NY, cov));
        for (int i = 0; i < 3; i++)
            assert_near(cov[i], shapes[k][i], 2e-4 * (shapes[k][0] + shapes[k][2]));
    }
}

static void test_what_has_no_shape(void **state) {
    double cov[3];
    (void)state;
    for (int i = 0; i < NX * NY; i++)
        image[i] = 0.0;
    assert_false(second_moments(image, NX, NY, cov));
    assert_true(isnan(cov[0]) && isnan(cov[1]) && isnan(cov[2]));
    for (int i = 0; i < NX * NY; i++)
        image[i] = -1.0;
    assert_false(second_moments(image, NX, NY, cov));
    for (int i = 0; i < NX * NY; i++)
        image[i] = 1.0; /* wider than the image */
    assert_false(second_moments(image, NX, NY, cov));
    image[7] = NAN;
    assert_false(second_moments(image, NX, NY, cov));
    draw((const double[]){4.0, 0.0, 4.0}, 20.0, 20.0, 1e300); /* sums are beyond a double */
    image[0] = INFINITY;
    assert_false(second_moments(image, NX, NY, cov));
}

/* The power of a Gaussian has half its inverse covariance. */
static void test_power(void **state) {
    static const double c[] = {5.0, 1.2, 3.0};
    const double det = c[0] * c[2] - c[1] * c[1];
    double k[] = {0.5 * c[2] / det, -0.5 * c[1] / det, 0.5 * c[0] / det};
    (void)state;
    second_moments_of_power(k);
    for (int i = 0; i < 3; i++)
        assert_near(k[i], c[i], 1e-12);
}

/* C on the sky is J C J^T of that in pixels. */
static void test_sky(void **state) {
    static const double c[] = {5.0, 1.2, 3.0};
    static const double j[] = {-0.2, 0.05, 0.07, 0.25};
    double sky[3] = {j[0] * j[0] * c[0] + 2.0 * j[0] * j[1] * c[1] + j[1] * j[1] * c[2],
                     j[0] * j[2] * c[0] + (j[0] * j[3] + j[1] * j[2]) * c[1] + j[1] * j[3] * c[2],
                     j[2] * j[2] * c[0] + 2.0 * j[2] * j[3] * c[1] + j[3] * j[3] * c[2]};
    (void)state;
    second_moments_to_pixels(sky, j);
    for (int i = 0; i < 3; i++)
        assert_near(sky[i], c[i], 1e-12);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gaussians),
        cmocka_unit_test(test_what_has_no_shape),
        cmocka_unit_test(test_power),
        cmocka_unit_test(test_sky),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
