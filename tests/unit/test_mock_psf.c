/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The PSFs of Zhang (2010), eq. (9), as painted points and as images. */
#include "test_mock_fixture.h"

#include <gsl/gsl_math.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static shear_mock *psf_mock(const char *kind, const char *r, const char *angle, const char *size) {
    return MOCK("psf", kind, "r-psf", r, "psf-angle", angle, "size", size, "r-gal", "0.5", "stamps",
                "1");
}

static double *paint(const shear_mock *m, double x, double y, double amplitude) {
    const shear_geometry *g = &shear_mock_get_info(m)->geometry;
    double *image = doubles((size_t)g->nx * (size_t)g->ny);
    assert_int_equal(shear_mock_paint(m, 0, 1, &x, &y, amplitude, image, NULL), SHEAR_OK);
    return image;
}

/* Every pixel of one painted point against the formula: 1e-12 of itself and 1e-20 of the peak (note
 * 3 of mock.h), which is also what the cut may take. Returns the number of pixels that the cut left
 * out. */
static int compare_point(const shear_mock *m, double x, double y) {
    const shear_mock_spec *s = shear_mock_get_spec(m);
    double peak = shear_mock_get_info(m)->psf_peak;
    double *image = paint(m, x, y, 1.0);
    int cut = 0;
    for (int j = 0; j < s->ny; j++) {
        for (int i = 0; i < s->nx; i++) {
            double w = reference_psf(s->psf, s->r_psf_px, s->psf_angle_deg, i - x, j - y);
            double p = image[j * s->nx + i];
            if (!(fabs(p - w) <= 1e-12 * w + 1e-20 * peak))
                fail_msg("pixel (%d, %d): %.17g instead of %.17g", i, j, p, w);
            cut += p == 0.0;
        }
    }
    free(image);
    return cut;
}

static void test_point_is_the_formula(void **state) {
    (void)state;
    static const char *const kinds[] = {"a", "b"};
    static const char *const radii[] = {"0.1", "0.5", "1.5", "4"};
    static const char *const angles[] = {"0", "30", "45", "90", "-137.5"};
    for (int k = 0; k < 2 * 4 * 5; k++) {
        shear_mock *m = psf_mock(kinds[k % 2], radii[k / 2 % 4], angles[k / 8], "72x61");
        compare_point(m, 35.0, 30.0);
        compare_point(m, 35.5, 30.25);
        compare_point(m, 36.187, 29.512);
        compare_point(m, -3.3, 59.9);   /* outside on the left */
        compare_point(m, 70.49, -0.49); /* in a corner */
        shear_mock_free(m);
    }
}

/* The cut is there (a small PSF leaves most of the stamp exactly zero) and not too early (test
 * above). */
static void test_tails_are_cut(void **state) {
    (void)state;
    shear_mock *a = psf_mock("a", "1.5", "30", "64");
    shear_mock *b = psf_mock("b", "1.5", "30", "64");
    int cut_a = compare_point(a, 31.6, 32.1);
    int cut_b = compare_point(b, 31.6, 32.1);
    /* The ellipse W_A = 1e-20, which the grid's cells and whole blocks make a little larger. */
    double inside = M_PI * 2.25 * 2.0 * 20.0 * M_LN10 / sqrt(0.8);
    assert_in_range(64 * 64 - cut_a, (uintmax_t)inside, (uintmax_t)(1.3 * inside));
    assert_true(cut_b > 64 * 64 / 3);
    assert_true(cut_b < cut_a);
    shear_mock_free(a);
    shear_mock_free(b);
}

static void test_points_add_up(void **state) {
    (void)state;
    const double x[] = {20.25, 22.5, 40.0};
    const double y[] = {20.5, 19.0, 63.25};
    shear_mock *m = psf_mock("b", "1.5", "30", "64");
    double *all = doubles(64 * 64);
    double *sum = doubles(64 * 64);
    assert_int_equal(shear_mock_paint(m, 0, 3, x, y, 2.5, all, NULL), SHEAR_OK);
    for (int k = 0; k < 3; k++) {
        double *one = paint(m, x[k], y[k], 1.0);
        for (int i = 0; i < 64 * 64; i++)
            sum[i] += 2.5 * one[i];
        free(one);
    }
    for (int i = 0; i < 64 * 64; i++)
        assert_true(fabs(all[i] - sum[i]) <= 1e-14 * sum[i]);
    free(all);
    free(sum);
    shear_mock_free(m);
}

static void test_far_points_add_nothing(void **state) {
    (void)state;
    const double x[] = {1e300, -1e9, 1000.0, 32.0};
    const double y[] = {32.0, 32.0, 32.0, -1e18};
    shear_mock *m = psf_mock("b", "1.5", "30", "64");
    double *image = doubles(64 * 64);
    double *zero = doubles(64 * 64);
    assert_int_equal(shear_mock_paint(m, 0, 4, x, y, 1.0, image, NULL), SHEAR_OK);
    assert_memory_equal(image, zero, 64 * 64 * sizeof *zero);
    free(image);
    free(zero);
    shear_mock_free(m);
}

struct moments {
    double flux, x, y, xx, yy, xy;
};

static struct moments moments_of(const double *image, int nx, int ny) {
    struct moments m = {0};
    for (int k = 0; k < nx * ny; k++) {
        m.flux += image[k];
        m.x += image[k] * (k % nx);
        m.y += image[k] * (k / nx);
    }
    m.x /= m.flux;
    m.y /= m.flux;
    for (int k = 0; k < nx * ny; k++) {
        double dx = k % nx - m.x;
        double dy = k / nx - m.y;
        m.xx += image[k] * dx * dx / m.flux;
        m.yy += image[k] * dy * dy / m.flux;
        m.xy += image[k] * dx * dy / m.flux;
    }
    return m;
}

/* On the pixel grid a Gaussian of R >= 2 has its integral and moments to exp(-2 pi^2 R^2) < 1e-34.
 */
static void test_gaussian_moments(void **state) {
    (void)state;
    static const double angle = 30.0 * M_PI / 180.0;
    shear_mock *m = psf_mock("a", "3", "30", "96x90");
    double *image = paint(m, 47.3, 44.85, 2.0);
    struct moments got = moments_of(image, 96, 90);
    double c2 = cos(angle) * cos(angle);
    double s2 = 1.0 - c2;
    assert_close(got.flux, 2.0 * 2.0 * M_PI * 9.0 / sqrt(0.8), 1e-11);
    assert_close(shear_mock_get_info(m)->psf_flux, 2.0 * M_PI * 9.0 / sqrt(0.8), 1e-12);
    assert_close(got.x, 47.3, 1e-11);
    assert_close(got.y, 44.85, 1e-11);
    assert_close(got.xx, 9.0 * (c2 + 1.25 * s2), 1e-11);
    assert_close(got.yy, 9.0 * (s2 + 1.25 * c2), 1e-11);
    assert_close(got.xy, -9.0 * 0.25 * cos(angle) * sin(angle), 1e-11);
    free(image);
    shear_mock_free(m);
}

/* The image with K samples per pixel: sum / K^2 is the integral; for W_B the closed form with K_0.
 * The long thin ends of the spikes need K R large: 24 samples per R leave 1e-8. */
static void test_image_flux(void **state) {
    (void)state;
    static const char *const kinds[] = {"a", "b"};
    for (int k = 0; k < 2; k++) {
        shear_mock *m = MOCK("psf", kinds[k], "r-psf", "1.5", "psf-angle", "20", "oversamp", "16");
        const shear_mock_info *info = shear_mock_get_info(m);
        size_t n = (size_t)info->geometry.psf_nx * (size_t)info->geometry.psf_ny;
        double *image = doubles(n);
        double sum = 0.0;
        shear_mock_psf_image(m, 0, image);
        for (size_t i = 0; i < n; i++)
            sum += image[i];
        assert_close(sum / 256.0 / info->psf_flux, 1.0, k == 0 ? 1e-13 : 1e-9);
        free(image);
        shear_mock_free(m);
    }
}

static void test_image_is_centred_and_complete(void **state) {
    (void)state;
    static const char *const kinds[] = {"a", "b"};
    for (enum shear_mock_psf k = 0; k < 2; k++) {
        shear_mock *m = MOCK("psf", kinds[k], "r-psf", "1.5", "psf-angle", "45", "oversamp", "3");
        const shear_mock_info *info = shear_mock_get_info(m);
        int n = info->geometry.psf_nx;
        double *image = doubles((size_t)n * (size_t)n);
        shear_mock_psf_image(m, 0, image);
        assert_int_equal(n % 2, 1);
        assert_int_equal(info->geometry.psf_ny, n);
        assert_int_equal(info->geometry.psf_oversample, 3);
        assert_close(image[(n * n - 1) / 2], info->psf_peak, 1e-15);
        for (int i = 0; i < n; i++) { /* nothing of note beyond the border */
            assert_true(image[i] <= 1e-20 * info->psf_peak);
            assert_true(image[i * n] <= 1e-20 * info->psf_peak);
        }
        for (int i = 0; i < n * n; i++) {
            double dx = (i % n - (n - 1) / 2) / 3.0;
            double dy = (i / n - (n - 1) / 2) / 3.0;
            double w = reference_psf(k, 1.5, 45.0, dx, dy);
            assert_true(fabs(image[i] - w) <= 1e-12 * w); /* exponents up to some 1000 */
        }
        free(image);
        shear_mock_free(m);
    }
}

static void test_image_of_even_size(void **state) {
    (void)state;
    shear_mock *m = MOCK("psf-size", "20", "r-psf", "2");
    double image[400];
    shear_mock_psf_image(m, 0, image);
    assert_close(image[9 * 20 + 10], reference_psf(0, 2.0, 30.0, 0.5, -0.5), 1e-15);
    shear_mock_free(m);
}

/* Turning the PSF by 90 degrees turns its image, (x, y) -> (-y, x), to the last bits. */
static void test_quarter_turn(void **state) {
    (void)state;
    shear_mock *m = psf_mock("b", "2", "25", "63");
    shear_mock *turned = psf_mock("b", "2", "115", "63");
    double *before = paint(m, 31.0, 31.0, 1.0);
    double *after = paint(turned, 31.0, 31.0, 1.0);
    double largest = 0.0;
    for (int j = 0; j < 63; j++) {
        for (int i = 0; i < 63; i++) {
            double b = before[j * 63 + i];
            double a = after[i * 63 + (62 - j)];
            assert_true(fabs(a - b) <= 1e-13 * b + 1e-20);
            largest = fmax(largest, fabs(b - before[i * 63 + (62 - j)]));
        }
    }
    assert_true(largest > 0.01); /* it is not round: the test could fail */
    free(before);
    free(after);
    shear_mock_free(m);
    shear_mock_free(turned);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_point_is_the_formula),
        cmocka_unit_test(test_tails_are_cut),
        cmocka_unit_test(test_points_add_up),
        cmocka_unit_test(test_far_points_add_nothing),
        cmocka_unit_test(test_gaussian_moments),
        cmocka_unit_test(test_image_flux),
        cmocka_unit_test(test_image_is_centred_and_complete),
        cmocka_unit_test(test_image_of_even_size),
        cmocka_unit_test(test_quarter_turn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
