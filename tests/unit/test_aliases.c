/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The aliases' share of the experiment narrow: closed forms, and the table of docs/method.md. */
#include "engine/aliases.h"
#include "test.h"

#include <math.h>
#include <stddef.h>

static double share(double r_psf_px, double beta_px, double half_light_px) {
    const double sigma[2] = {r_psf_px, r_psf_px};
    return aliases_share(beta_px, sigma, disk_power, &half_light_px);
}

static void assert_near(double measured, double known, double part) {
    if (!(fabs(measured / known - 1.0) <= part))
        fail_msg("%.6g, not %.6g +- %.2g of it", measured, known, part);
}

/* Points, over the whole plane: the integrand of alias a is a Gaussian about k = -c a,
 * c = 2 pi R^2 / beta^2, of which there remain, relative to the signal's 1/beta^2,
 * (1 + beta^2 c^2 a^2) exp(beta^2 c^2 a^2 - 4 pi^2 R^2 a^2). Beyond Nyquist a wide target has
 * nothing. */
static void test_points(void **state) {
    (void)state;
    static const double cases[][2] = {{0.3, 2.5}, {0.5, 2.2}, {0.7, 3.0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const double r = cases[i][0];
        const double beta = cases[i][1];
        const double c = 2.0 * M_PI * r * r / beta;
        double known = 0.0;
        for (int a = 0; a < 49; a++) {
            const int x = a % 7 - 3;
            const int y = a / 7 - 3;
            const double q = x * x + y * y;
            known +=
                q > 0.0 ? (1.0 + c * c * q) * exp(q * (c * c - 4.0 * M_PI * M_PI * r * r)) : 0.0;
        }
        assert_near(share(r, beta, 0.0), known, 1e-5);
    }
}

/* docs/method.md, section 1: to the last digit of what is printed there. */
static void test_table(void **state) {
    (void)state;
    static const double betas[] = {1.0, 1.2, 1.4};
    static const struct {
        double r_psf_px, half_light_px, share[3], digit[3];
    } rows[] = {
        {0.5, 0.0, {8e-3, 3e-3, 2e-3}, {1e-3, 1e-3, 1e-3}},
        {0.5, 0.5, {6.9e-4, 1.6e-4, 6.0e-5}, {1e-5, 1e-5, 1e-6}},
        {0.5, 1.0, {7.1e-5, 1.2e-5, 3.6e-6}, {1e-6, 1e-6, 1e-7}},
        {0.4, 0.0, {0.04, 0.02, 0.02}, {0.01, 0.01, 0.01}},
        {0.4, 0.5, {2.4e-3, 9.7e-4, 5.3e-4}, {1e-4, 1e-5, 1e-5}},
        {0.4, 1.0, {2.2e-4, 6.7e-5, 3.0e-5}, {1e-5, 1e-6, 1e-6}},
        {0.3, 0.0, {0.22, 0.18, 0.16}, {0.01, 0.01, 0.01}},
        {0.3, 0.5, {8.9e-3, 5.2e-3, 3.7e-3}, {1e-4, 1e-4, 1e-4}},
        {0.3, 1.0, {7.3e-4, 3.3e-4, 1.9e-4}, {1e-5, 1e-5, 1e-5}},
        {0.3, 2.0, {6e-5, 2e-5, 1e-5}, {1e-5, 1e-5, 1e-5}},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        for (int b = 0; b < 3; b++) {
            const double a = share(rows[i].r_psf_px, betas[b], rows[i].half_light_px);
            if (!(fabs(a - rows[i].share[b]) <= 0.51 * rows[i].digit[b])) {
                fail_msg("R_PSF %g, h %g, beta %g: %.4g, not %g", rows[i].r_psf_px,
                         rows[i].half_light_px, betas[b], a, rows[i].share[b]);
            }
        }
    }
}

/* A PSF that is longer along y has fewer aliases there; turned, it has the same. */
static void test_axes(void **state) {
    (void)state;
    const double along_y[] = {0.4, 0.6};
    const double along_x[] = {0.6, 0.4};
    const double h = 1.0;
    const double a = aliases_share(1.4, along_y, disk_power, &h);
    assert_near(aliases_share(1.4, along_x, disk_power, &h), a, 1e-9);
    assert_true(a < share(0.4, 1.4, h) && a > share(0.6, 1.4, h));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points),
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_axes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
