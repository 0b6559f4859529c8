/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The PSF's scale radius: exact for Gaussians, sensible for odd shapes, and what is no PSF. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "shear/plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double radius_of(const double *psf, int nx, int ny, int oversample) {
    double r = NAN;
    shear_error err = {0};
    if (shear_psf_radius(psf, nx, ny, oversample, &r, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    return r;
}

static double radius_of_gaussian(const gaussian *g, int nx, int ny, int oversample) {
    double *psf = calloc((size_t)nx * (size_t)ny, sizeof *psf);
    assert_non_null(psf);
    gaussian_draw(g, nx, ny, oversample, psf);
    const double r = radius_of(psf, nx, ny, oversample);
    free(psf);
    return r;
}

/* exp(-q/2) > exp(-1/2) inside the ellipse q < 1, whose area is pi sqrt(det C): R = det^(1/4). The
 * logarithm of a Gaussian is interpolated exactly; what remains is the contour's chords on subcells
 * of 1/32 (small PSFs) to 1/2 sample, and the climb to the peak in steps of 1e-3: 7e-4 of the
 * radius at worst. */
static void test_gaussians(void **state) {
    (void)state;
    static const struct {
        double r;
        int oversample;
    } cases[] = {{0.3, 2}, {0.5, 1}, {0.5, 3}, {0.5, 16}, {0.7, 1}, {1.0, 1},
                 {1.5, 1}, {1.5, 7}, {3.3, 1}, {3.0, 4},  {8.0, 1}};
    uint64_t seed = 21;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int k = 0; k < 4; k++) {
            const double r = cases[i].r;
            const double stretch = 1.0 + 0.7 * uniform(&seed);
            const double lean = 0.3 * (uniform(&seed) - 0.5);
            const int n = (int)(10.0 * r * cases[i].oversample) + 9;
            const double centre = 0.5 * n / cases[i].oversample;
            const double pixel = 1.0 / cases[i].oversample;
            const gaussian g = {exp(20.0 * uniform(&seed) - 10.0),
                                r * r * stretch,
                                r * r / stretch,
                                r * r * lean,
                                centre + pixel * (uniform(&seed) - 0.5),
                                centre + pixel * (uniform(&seed) - 0.5)};
            const double expected = pow(g.xx * g.yy - g.xy * g.xy, 0.25);
            assert_near(radius_of_gaussian(&g, n, n + 2, cases[i].oversample), expected, 1e-3,
                        expected, "R_PSF");
        }
    }
}

/* The radius scales with the sampling and not with the flux. */
static void test_scaling(void **state) {
    (void)state;
    const gaussian g = {1.0, 2.0, 1.5, 0.2, 10.2, 9.7};
    double psf[20 * 20];
    gaussian_draw(&g, 20, 20, 1, psf);
    const double r = radius_of(psf, 20, 20, 1);
    assert_near(radius_of(psf, 20, 20, 4), 0.25 * r, 1e-15, r, "sampling");
    for (int i = 0; i < 400; i++)
        psf[i] *= 1e-30;
    assert_near(radius_of(psf, 20, 20, 1), r, 1e-9, r, "flux");
}

/* Two peaks of equal height, far apart: twice the area. With one at 0.55 of the other (below
 * exp(-1/2)): one peak's. */
static void test_two_peaks(void **state) {
    (void)state;
    double psf[48 * 24];
    double second[48 * 24];
    for (int low = 0; low < 2; low++) {
        const gaussian a = {1.0, 4.0, 4.0, 0.0, 12.0, 12.0};
        const gaussian b = {low != 0 ? 0.55 : 1.0, 4.0, 4.0, 0.0, 36.0, 12.0};
        gaussian_draw(&a, 48, 24, 1, psf);
        gaussian_draw(&b, 48, 24, 1, second);
        for (int i = 0; i < 48 * 24; i++)
            psf[i] += second[i];
        assert_near(radius_of(psf, 48, 24, 1), low != 0 ? 2.0 : 2.0 * sqrt(2.0), 1e-3, 2.0,
                    "two peaks");
    }
}

/* A smooth function of the distance r from (20.3, 19.8). */
static double radius_of_profile(double (*profile)(double)) {
    double psf[40 * 40];
    for (int i = 0; i < 1600; i++)
        psf[i] = profile(hypot(i % 40 - 20.3, i / 40 - 19.8));
    return radius_of(psf, 40, 40, 1);
}

static double flat_top(double r) {
    return 1.0 / (1.0 + exp(1.5 * (r - 8.0)));
}

static double ring(double r) {
    return exp(-0.5 * (r - 9.0) * (r - 9.0) / 4.0);
}

static double moffat(double r) {
    return pow(1.0 + r * r / 16.0, -2.5);
}

/* Where the profile falls through exp(-1/2), in closed form. Between samples these are no parabolas
 * in the logarithm: what the cubic misses of the peak moves the contour by some parts in a
 * thousand. */
static void test_other_profiles(void **state) {
    (void)state;
    assert_near(radius_of_profile(flat_top), 8.0 + log(exp(0.5) - 1.0) / 1.5, 5e-3, 8.0,
                "flat top");
    assert_near(radius_of_profile(ring), sqrt(121.0 - 49.0), 5e-3, 8.0,
                "ring"); /* between 9 - 2 and 9 + 2 */
    assert_near(radius_of_profile(moffat), 4.0 * sqrt(exp(0.2) - 1.0), 3e-3, 2.0, "Moffat");
}

/* A single sample: the bilinear pyramid's area above exp(-1/2), 4 (1 - L + L ln L). Zeros around:
 * no logarithms. */
static void test_single_sample(void **state) {
    (void)state;
    double psf[81] = {0};
    const double level = exp(-0.5);
    psf[40] = 5.0;
    const double expected = sqrt(4.0 * (1.0 - level + level * log(level)) / M_PI);
    assert_near(radius_of(psf, 9, 9, 1), expected, 2e-3, expected, "single sample");
}

/* A peak on the border or in the corner: half the ellipse, or a quarter, and half a sample more on
 * each side that is cut. A PSF that fills its image has the image's area. */
static void test_cut_off(void **state) {
    (void)state;
    for (int corner = 0; corner < 3; corner++) {
        const gaussian g = {1.0, 9.0, 9.0, 0.0, corner > 0 ? 0.0 : 9.5, corner == 1 ? 19.0 : 0.0};
        const double area = corner > 0 ? 9.0 * M_PI / 4.0 + 3.0 + 0.25 : 9.0 * M_PI / 2.0 + 3.0;
        const double expected = sqrt(area / M_PI);
        assert_near(radius_of_gaussian(&g, 20, 20, 1), expected, 1e-2, expected, "cut off");
    }
    const gaussian wide = {1.0, 1e6, 1e6, 0.0, 4.0, 4.0};
    assert_near(radius_of_gaussian(&wide, 9, 9, 1), sqrt(81.0 / M_PI), 1e-12, 5.0, "full");
}

static void check_bad(const double *psf, const char *word) {
    double r;
    shear_error err = {0};
    assert_int_equal(shear_psf_radius(psf, 8, 8, 1, &r, &err), SHEAR_E_PSF);
    assert_int_equal(err.code, SHEAR_E_PSF);
    assert_non_null(strstr(err.message, word));
    assert_true(err.advice[0] != '\0');
    assert_int_equal(shear_psf_radius(psf, 8, 8, 1, &r, NULL), SHEAR_E_PSF);
}

static void test_bad_psfs(void **state) {
    (void)state;
    double psf[64] = {0};
    check_bad(psf, "not positive");
    for (int i = 0; i < 64; i++)
        psf[i] = -1.0;
    check_bad(psf, "not positive");
    psf[10] = 10.0; /* a peak, but no flux */
    check_bad(psf, "not positive");
    psf[11] = 1e300;
    psf[19] = NAN;
    check_bad(psf, "(4, 3)");
    psf[19] = INFINITY;
    check_bad(psf, "(4, 3)");
    for (int i = 0; i < 64; i++)
        psf[i] = 1e307;
    check_bad(psf, "sum is inf");
}

/* The same through a plan, with the smallest image that is one. */
static void test_plan_refuses(void **state) {
    (void)state;
    pair p;
    shear_row row;
    shear_error err = {0};
    pair_init(&p, 16, 16, 9, 9, 1);
    assert_int_equal(pair_try(&p, &row, &err), SHEAR_E_PSF);
    pair_draw(&p, 1.1, 1);
    p.psf[40] = NAN;
    assert_int_equal(pair_try(&p, &row, &err), SHEAR_E_PSF);
    const int sizes[][3] = {{1, 9, 1}, {9, 1, 1}, {0, 0, 1}, {9, 9, 0}, {9, 9, -1}};
    for (int i = 0; i < 5; i++) {
        pair_draw(&p, 1.1, 1);
        p.geometry.psf_nx = sizes[i][0];
        p.geometry.psf_ny = sizes[i][1];
        p.geometry.psf_oversample = sizes[i][2];
        assert_int_equal(pair_try(&p, &row, &err), SHEAR_E_PSF);
    }
    pair_deinit(&p);
}

/* OVERSAMP comes from a file: absurd numbers must neither overflow nor eat the memory. */
static void test_absurd_oversampling(void **state) {
    (void)state;
    static const int oversamples[] = {1 << 20, INT32_MAX / 8, INT32_MAX};
    static const char *const methods[] = {"none", "log-bicubic", "auto"};
    for (int i = 0; i < 3; i++) {
        for (int m = 0; m < 3; m++) {
            pair p;
            shear_row row;
            shear_error err = {0};
            pair_init(&p, 64, 64, 9, 9, 1);
            pair_draw(&p, 1.1, 1);
            p.geometry.psf_oversample = oversamples[i];
            pair_set(&p, "interpolation", methods[m]);
            pair_set(&p, "beta", "2");
            assert_int_not_equal(pair_try(&p, &row, &err), SHEAR_OK);
            assert_true(err.code == SHEAR_E_PSF || err.code == SHEAR_E_SETTING);
            pair_deinit(&p);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gaussians),
        cmocka_unit_test(test_scaling),
        cmocka_unit_test(test_two_peaks),
        cmocka_unit_test(test_other_profiles),
        cmocka_unit_test(test_single_sample),
        cmocka_unit_test(test_cut_off),
        cmocka_unit_test(test_bad_psfs),
        cmocka_unit_test(test_plan_refuses),
        cmocka_unit_test(test_absurd_oversampling),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
