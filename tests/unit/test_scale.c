/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a row depends on brightness: units of flux, noise, PSFs of another flux or sampling; and
 * stamps of every size. */
#include "gaussian.h"
#include "oracle.h"
#include "pair.h"
#include "test.h"

#include <math.h>
#include <string.h>

static shear_row times(shear_row r, double a2) {
    double *numbers[] = {&r.m20, &r.m02, &r.m11, &r.m4, &r.u, &r.v, &r.n1, &r.n2, &r.d};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        *numbers[i] *= a2;
    return r;
}

static void multiply(double *x, int n, double a) {
    for (int i = 0; i < n; i++)
        x[i] *= a;
}

/* All moments go with the square of the flux. By a power of two nothing rounds, and without
 * logarithms every bit must agree; ln(a) up to 46 beside ln(pixel) costs the log methods two
 * digits. */
static void check_flux(int method, double a, const char *zeros) {
    pair p;
    pair_init(&p, 20, 23, 15, 15, 1);
    pair_draw(&p, 1.1, 7);
    p.galaxy[25] = p.noise[40] = p.galaxy[26] = 0.0;
    pair_set(&p, "interpolation", pair_methods[method]);
    pair_set(&p, "zeros", zeros);
    p.settings.pedestal = method >= 4 && a > 1.0 ? 0.125 : 0.0;
    const shear_row before = pair_measure(&p);
    multiply(p.galaxy, 20 * 23, a);
    multiply(p.noise, 20 * 23, a);
    p.settings.pedestal *= a;
    const shear_row after = pair_measure(&p);
    int exponent;
    const bool exact = method < 4 && frexp(a, &exponent) == 0.5;
    const shear_row expected = times(before, a * a);
    assert_rows_near(&after, &expected, exact ? 0.0 : 1e-11);
    assert_near(after.flux, a * before.flux, exact ? 0.0 : 1e-13, a * before.flux, "flux");
    assert_near(after.snr, copysign(before.snr, a), exact ? 0.0 : 1e-10, before.snr, "snr");
    pair_deinit(&p);
}

static void test_flux(void **state) {
    (void)state;
    static const double scales[] = {0x1p-66, 0x1p10, 1e-20, 3.7, 1e20, -2.0};
    for (int m = 0; m < PAIR_METHODS; m++) {
        for (int i = 0; i < 5; i++) {
            check_flux(m, scales[i], "floor");
            check_flux(m, scales[i], "skip");
        }
    }
    for (int m = 0; m < 4; m++) { /* a negative image has the power of its positive */
        check_flux(m, scales[5], "skip");
    }
}

/* The PSF's flux drops out. */
static void test_psf_flux(void **state) {
    (void)state;
    static const double scales[] = {0x1p-66, 5.1, 1e20, 1e-150, 1e200};
    for (int m = 0; m < PAIR_METHODS; m++) {
        for (int i = 0; i < 5; i++) {
            pair p;
            pair_init(&p, 20, 20, 15, 15, 1);
            pair_draw(&p, 0.8, 70);
            pair_set(&p, "interpolation", pair_methods[m]);
            pair_set(&p, "beta", "1.6");
            const shear_row before = pair_measure(&p);
            multiply(p.psf, 15 * 15, scales[i]);
            const shear_row after = pair_measure(&p);
            assert_rows_near(&after, &before, i == 0 && m < 4 ? 0.0 : 1e-10);
            pair_deinit(&p);
        }
    }
}

static shear_row minus(const shear_row *a, const shear_row *b) {
    return (shear_row){.m20 = a->m20 - b->m20,
                       .m02 = a->m02 - b->m02,
                       .m11 = a->m11 - b->m11,
                       .m4 = a->m4 - b->m4,
                       .u = a->u - b->u,
                       .v = a->v - b->v,
                       .n1 = a->n1 - b->n1,
                       .n2 = a->n2 - b->n2,
                       .d = a->d - b->d};
}

/* Zhang (2010), eq. (8): the pair's moments are the galaxy's minus the noise's. */
static void test_noise_correction(void **state) {
    (void)state;
    for (int m = 0; m < PAIR_METHODS; m++) {
        pair p;
        pair_init(&p, 21, 18, 15, 15, 1);
        pair_draw(&p, 1.05, 3);
        pair_set(&p, "interpolation", pair_methods[m]);
        pair_set(&p, "filter", m % 2 ? "edge" : "none");
        pair_set(&p, "background", "keep"); /* else each has a level of its own */
        const shear_row both = pair_measure(&p);
        pair_set(&p, "noise-correction", "off");
        const shear_row galaxy = pair_measure(&p);
        assert_near(galaxy.flux, both.flux, 0.0, 1.0, "the flux is always corrected");
        memcpy(p.galaxy, p.noise, 21 * 18 * sizeof(double));
        const shear_row noise = pair_measure(&p);
        const shear_row difference = minus(&galaxy, &noise);
        assert_rows_near(&both, &difference, 1e-12);
        pair_set(&p, "noise-correction", "on"); /* galaxy = noise: nothing is left */
        const shear_row nothing = pair_measure(&p);
        assert_true(fabs(nothing.d) <= 1e-13 * fabs(noise.d) &&
                    fabs(nothing.m4) <= 1e-13 * noise.m4);
        assert_true(nothing.flux == 0.0 && nothing.border_mean == 0.0 && nothing.border_var == 0.0);
        pair_deinit(&p);
    }
}

/* A noise stamp of zeros subtracts nothing, under every method and policy. */
static void test_zero_noise(void **state) {
    (void)state;
    for (int m = 0; m < PAIR_METHODS; m++) {
        for (int policy = 0; policy < 2; policy++) {
            pair p;
            pair_init(&p, 16, 16, 15, 15, 1);
            pair_draw(&p, 1.05, 3);
            memset(p.noise, 0, 16 * 16 * sizeof(double));
            pair_set(&p, "interpolation", pair_methods[m]);
            pair_set(&p, "zeros", policy == 0 ? "skip" : "floor");
            const shear_row with = pair_measure(&p);
            pair_set(&p, "noise-correction", "off");
            const shear_row without = pair_measure(&p);
            assert_rows_near(&with, &without, 1e-14);
            assert_true(isnan(with.snr));
            pair_deinit(&p);
        }
    }
}

/* The same Gaussian PSF at several samplings. R_PSF = 2 px: one sample a pixel is enough to 1e-9.
 */
static void test_psf_sampling(void **state) {
    (void)state;
    shear_row first = {0};
    for (int q = 1; q <= 5; q++) {
        const gaussian psf = {1.0, 4.2, 3.8, 0.3, 15.3, 14.8};
        pair p;
        pair_init(&p, 40, 40, 15, 15, 1);
        pair_draw(&p, 1.0, 12);
        pair sampled;
        pair_init(&sampled, 40, 40, 31 * q, 30 * q, q);
        memcpy(sampled.galaxy, p.galaxy, 1600 * sizeof(double));
        gaussian_draw(&psf, 31 * q, 30 * q, q, sampled.psf);
        pair_set(&sampled, "interpolation", "none");
        pair_set(&sampled, "beta", "3");
        const shear_row row = pair_measure(&sampled);
        first = q == 1 ? row : first;
        assert_rows_near(&row, &first, 1e-9);
        pair_deinit(&p);
        pair_deinit(&sampled);
    }
}

/* Against the closed form: the PSF's edge at 7 px is 1e-9 of its peak, and T divides by |W|^2. */
static void check_size(int nx, int ny) {
    const gaussian galaxy = {1.0, 6.0, 5.0, 0.2, 0.5 * nx - 0.4, 0.5 * ny - 0.6};
    const gaussian psf = {1.0, 1.2, 1.2, 0.0, 7.0, 7.0};
    pair p;
    shear_plan_info info;
    pair_init(&p, nx, ny, 15, 15, 1);
    gaussian_draw(&galaxy, nx, ny, 1, p.galaxy);
    gaussian_draw(&psf, 15, 15, 1, p.psf);
    const shear_row row = pair_measure_info(&p, &info);
    const shear_row exact = gaussian_row(&galaxy, &psf, info.beta_px);
    assert_rows_near(&row, &exact, 1e-6);
    pair_deinit(&p);
}

/* Against the oracle, which does not ask that anything fits. */
static void check_short_side(int nx, int ny) {
    pair p;
    shear_plan_info info;
    double k_cut;
    pair_init(&p, nx, ny, 11, 11, 1);
    pair_draw(&p, 1.1, 6);
    const shear_row row = pair_measure_info(&p, &info);
    const shear_row exact = oracle_measure(&info, &p.settings, p.galaxy, p.noise, p.psf, &k_cut);
    assert_rows_near(&row, &exact, 1e-10);
    pair_deinit(&p);
}

static void test_sizes(void **state) {
    (void)state;
    check_size(31, 37);
    check_size(127, 31);
    check_size(1024, 1024);
    check_size(1021, 64);
    check_short_side(8, 8);
    check_short_side(9, 8);
    check_short_side(8, 1024);
    check_short_side(1024, 8);
}

static void test_size_limits(void **state) {
    (void)state;
    const int sizes[][2] = {{7, 8}, {8, 7}, {1025, 8}, {8, 1025}, {0, 0}, {-8, 8}};
    for (int i = 0; i < 6; i++) {
        pair p;
        shear_row row;
        shear_error err = {0};
        pair_init(&p, 8, 8, 9, 9, 1);
        pair_draw(&p, 1.1, 1);
        p.geometry.nx = sizes[i][0];
        p.geometry.ny = sizes[i][1];
        assert_int_equal(pair_try(&p, &row, &err), SHEAR_E_FORMAT);
        assert_non_null(strstr(err.message, "8 to 1024"));
        pair_deinit(&p);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_flux),
        cmocka_unit_test(test_psf_flux),
        cmocka_unit_test(test_noise_correction),
        cmocka_unit_test(test_zero_noise),
        cmocka_unit_test(test_psf_sampling),
        cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_size_limits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
