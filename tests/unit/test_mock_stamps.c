/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stamps: flux, position, the symmetry of rotated pairs, independence of threads, chunks, shear and
 * each other. */
#include "test_mock_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 48, PIXELS = SIDE * SIDE };

/* Flux = points * integral of W * det A; the stamp and R_PSF are large enough for 1e-11. */
static void test_flux(void **state) {
    (void)state;
    shear_mock *m = MOCK("size", "80", "shear", "0.2,-0.3", "points", "50", "bitpix", "-64");
    double *galaxy, *noise;
    make_stamps(m, 0, 4, 1, &galaxy, &noise);
    double expected = 50.0 * shear_mock_get_info(m)->psf_flux * (1.0 - 0.04 - 0.09);
    for (int i = 0; i < 4; i++)
        assert_close(80.0 * 80.0 * mean_of(galaxy + i * 6400, 6400), expected, 1e-11 * expected);
    assert_true(mean_of(noise, 4 * 6400) == 0.0); /* no noise asked for */
    free(galaxy);
    free(noise);
    shear_mock_free(m);
}

/* The flux-weighted centre of a stamp is CATALOG's position plus the mean of the lensed points. */
static void test_position(void **state) {
    (void)state;
    shear_mock *m = MOCK("size", "80x72", "offset", "3,-2.5", "shear", "0.05,0.1", "points", "40");
    double *galaxy, *noise;
    double u[40], v[40];
    make_stamps(m, 0, 6, 1, &galaxy, &noise);
    for (int i = 0; i < 6; i++) {
        double flux = 0.0, x = 0.0, y = 0.0, cx, cy;
        const double *image = galaxy + i * 80 * 72;
        for (int k = 0; k < 80 * 72; k++) {
            flux += image[k];
            x += image[k] * (k % 80);
            y += image[k] * (k / 80);
        }
        shear_mock_image_points(m, i, u, v);
        shear_mock_centre(m, i, &cx, &cy);
        assert_close(x / flux, 39.5 + cx + mean_of(u, 40), 1e-10);
        assert_close(y / flux, 35.5 + cy + mean_of(v, 40), 1e-10);
        assert_close(cx, 3.0, 0.5);
        assert_close(cy, -2.5, 0.5);
    }
    free(galaxy);
    free(noise);
    shear_mock_free(m);
}

static double shift_cdf(double x, void *context) {
    (void)context;
    return x + 0.5;
}

static void test_shift(void **state) {
    (void)state;
    enum { N = 4000 };
    shear_mock *own = MOCK("rotate", "4", "stamps", "4000");
    shear_mock *shared = MOCK("rotate", "4", "share-shift", "yes");
    shear_mock *none = MOCK("no-shift", "yes", "offset", "1.5,2");
    double *x = doubles(N), *y = doubles(N);
    double first[2], second[2];
    for (int i = 0; i < N; i++)
        shear_mock_centre(own, i, &x[i], &y[i]);
    assert_true(x[0] != x[1] && x[0] != y[0]);
    assert_true(ks_of(x, N, shift_cdf, NULL) < 1.95);
    assert_true(ks_of(y, N, shift_cdf, NULL) < 1.95);
    shear_mock_centre(shared, 4, &first[0], &first[1]);
    shear_mock_centre(shared, 7, &second[0], &second[1]);
    assert_memory_equal(first, second, sizeof first);
    shear_mock_centre(shared, 8, &second[0], &second[1]);
    assert_true(first[0] != second[0]);
    shear_mock_centre(none, 1, &first[0], &first[1]);
    assert_true(first[0] == 1.5 && first[1] == 2.0);
    free(x);
    free(y);
    shear_mock_free(own);
    shear_mock_free(shared);
    shear_mock_free(none);
}

/* The galaxy at 90 degrees under +g and a PSF turned by 90 degrees is the galaxy at 0 under -g,
 * turned: spin 2. */
static void check_quarter_turn(const char *rotate, int64_t from, int64_t to) {
    shear_mock *plus = MOCK("size", "48", "shear", "0.1,-0.05", "psf", "b", "psf-angle", "110",
                            "no-shift", "yes", "rotate", rotate);
    shear_mock *minus = MOCK("size", "48", "shear", "-0.1,0.05", "psf", "b", "psf-angle", "20",
                             "no-shift", "yes", "rotate", rotate);
    double *turned, *plain, *noise_a, *noise_b;
    make_stamps(plus, to, 1, 1, &turned, &noise_a);
    make_stamps(minus, from, 1, 1, &plain, &noise_b);
    double change = 0.0;
    for (int j = 0; j < SIDE; j++) {
        for (int i = 0; i < SIDE; i++) {
            double b = plain[j * SIDE + i];
            assert_close(turned[i * SIDE + (SIDE - 1 - j)], b, 1e-12 * b + 1e-16);
            change = fmax(change, fabs(b - turned[j * SIDE + i]));
        }
    }
    assert_true(change > 1.0);
    free(turned);
    free(plain);
    free(noise_a);
    free(noise_b);
    shear_mock_free(plus);
    shear_mock_free(minus);
}

static void test_quarter_turn(void **state) {
    (void)state;
    check_quarter_turn("2", 4, 5);
    check_quarter_turn("4", 4, 6);
    check_quarter_turn("4", 5, 7);
}

#define ALL_NOISES                                                                                 \
    "size", "32x24", "r-gal", "4", "points", "50", "noise-ratio", "0.5", "photons", "20", "white", \
        "1.5", "stamps", "7", "psf-per-stamp", "yes", "psf", "b", "r-psf", "1"

/* To the last bit, whoever makes which stamp. */
static void test_threads_and_chunks(void **state) {
    (void)state;
    enum { N = 32 * 24, COUNT = 7 };
    shear_mock *m = MOCK(ALL_NOISES);
    double *galaxy, *noise, *g, *n;
    make_stamps(m, 0, COUNT, 1, &galaxy, &noise);
    static const int threads[] = {2, 7, 0};
    for (int t = 0; t < 3; t++) {
        make_stamps(m, 0, COUNT, threads[t], &g, &n);
        assert_memory_equal(g, galaxy, COUNT * N * sizeof *g);
        assert_memory_equal(n, noise, COUNT * N * sizeof *n);
        free(g);
        free(n);
    }
    static const int chunks[] = {1, 3};
    for (int c = 0; c < 2; c++) {
        for (int first = 0; first < COUNT; first += chunks[c]) {
            int count = first + chunks[c] > COUNT ? COUNT - first : chunks[c];
            make_stamps(m, first, count, 2, &g, &n);
            assert_memory_equal(g, galaxy + first * N, (size_t)count * N * sizeof *g);
            assert_memory_equal(n, noise + first * N, (size_t)count * N * sizeof *n);
            free(g);
            free(n);
        }
    }
    free(galaxy);
    free(noise);
    shear_mock_free(m);
}

/* Another shear: the same noise stamps to the last bit, and the same noise on the galaxies. */
static void test_noise_does_not_know_the_shear(void **state) {
    (void)state;
    double *image[4], *noise[4];
    static const char *const shears[] = {"0.02,-0.03", "-0.1,0.05"};
    for (int k = 0; k < 2; k++) {
        shear_mock *noisy =
            MOCK("size", "48", "noise-ratio", "0.5", "white", "1.5", "shear", shears[k]);
        shear_mock *clean = MOCK("size", "48", "shear", shears[k]);
        make_stamps(noisy, 3, 1, 1, &image[k], &noise[k]);
        make_stamps(clean, 3, 1, 1, &image[k + 2], &noise[k + 2]);
        shear_mock_free(noisy);
        shear_mock_free(clean);
    }
    assert_memory_equal(noise[0], noise[1], PIXELS * sizeof(double));
    for (int i = 0; i < PIXELS; i++)
        assert_close(image[0][i] - image[2][i], image[1][i] - image[3][i], 1e-12);
    for (int k = 0; k < 4; k++) {
        free(image[k]);
        free(noise[k]);
    }
}

/* Two noises together are the sum of each alone. */
static void test_noises_do_not_know_each_other(void **state) {
    (void)state;
    shear_mock *both = MOCK("size", "48", "noise-ratio", "0.5", "white", "1.5");
    shear_mock *sources = MOCK("size", "48", "noise-ratio", "0.5");
    shear_mock *white = MOCK("size", "48", "white", "1.5");
    double *g[3], *n[3];
    make_stamps(both, 3, 1, 1, &g[0], &n[0]);
    make_stamps(sources, 3, 1, 1, &g[1], &n[1]);
    make_stamps(white, 3, 1, 1, &g[2], &n[2]);
    double correlation = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        assert_close(n[0][i], n[1][i] + n[2][i], 1e-12);
        correlation += n[2][i] * (g[0][i] - g[1][i]) / (1.5 * 1.5 * PIXELS);
    }
    /* The galaxy's noise is another draw than the noise stamp's. */
    assert_close(correlation, 0.0, 4.0 / SIDE);
    for (int k = 0; k < 3; k++) {
        free(g[k]);
        free(n[k]);
    }
    shear_mock_free(both);
    shear_mock_free(sources);
    shear_mock_free(white);
}

/* In the first row, far from the galaxy, the two stamps of a pair differ, whatever the noise. */
static void test_galaxy_and_noise_stamps_differ(void **state) {
    (void)state;
    static const char *const kinds[] = {"white", "noise-ratio", "photons"};
    for (int k = 0; k < 3; k++) {
        shear_mock *m = MOCK("size", "48", "r-psf", "1", "r-gal", "4", kinds[k], "100");
        double *g, *n;
        int equal = 0;
        make_stamps(m, 2, 1, 1, &g, &n);
        for (int i = 0; i < SIDE; i++)
            equal += g[i] == n[i];
        assert_true(equal < SIDE / 4); /* counts of photons may coincide */
        free(g);
        free(n);
        shear_mock_free(m);
    }
}

static void test_shared_noise(void **state) {
    (void)state;
    shear_mock *own = MOCK("size", "48", "white", "1", "noise-ratio", "1", "rotate", "2");
    shear_mock *shared =
        MOCK("size", "48", "white", "1", "noise-ratio", "1", "rotate", "2", "share-noise", "yes");
    double *g, *n;
    make_stamps(own, 4, 2, 1, &g, &n);
    assert_memory_not_equal(n, n + PIXELS, PIXELS * sizeof *n);
    free(g);
    free(n);
    make_stamps(shared, 4, 3, 1, &g, &n);
    assert_memory_equal(n, n + PIXELS, PIXELS * sizeof *n);
    assert_memory_not_equal(n, n + 2 * PIXELS, PIXELS * sizeof *n);
    free(g);
    free(n);
    shear_mock_free(own);
    shear_mock_free(shared);
}

/* Copies as whole stamps turned, under -g and a PSF turned as well, show the very same pixels, all
 * noises included, turned. (Of thousands of photon counts a few feel the rounding of their mean.)
 */
static void check_turned(const char *photons, int may_differ) {
#define NOISY                                                                                      \
    "size", "48", "rotate", "4", "turn-stamps", "yes", "offset", "2,-1", "psf", "b", "white", "1", \
        "noise-ratio", "1", "photons", photons
    shear_mock *first = MOCK(NOISY, "psf-angle", "20", "shear", "0.1,-0.05");
    shear_mock *turned = MOCK(NOISY, "psf-angle", "110", "shear", "-0.1,0.05");
    double *stamps[2], *twins[2];
    int differ = 0;
    make_stamps(first, 4, 2, 1, &stamps[0], &stamps[1]);
    make_stamps(turned, 6, 2, 1, &twins[0], &twins[1]);
    for (int s = 0; s < 2; s++) {
        for (int i = 0; i < 2 * PIXELS; i++) {
            int x = i % SIDE, y = i / SIDE % SIDE;
            int to = i - i % PIXELS + x * SIDE + SIDE - 1 - y;
            differ += fabs(twins[s][to] - stamps[s][i]) > 1e-9;
        }
        free(stamps[s]);
        free(twins[s]);
    }
    assert_in_range(differ, 0, may_differ);
    shear_mock_free(first);
    shear_mock_free(turned);
}

static void test_turned_stamps(void **state) {
    (void)state;
    check_turned("0", 0);
    check_turned("50", 9);
}

/* The galaxy of `stamp`, painted once more point by point with the PSF that the mock names for it.
 */
static void check_psf_of_stamp(const shear_mock *m, int64_t stamp) {
    const shear_mock_spec *s = shear_mock_get_spec(m);
    double u[600], v[600], cx, cy;
    double *image = doubles(PIXELS), *galaxy, *noise;
    int n = shear_mock_image_points(m, stamp, u, v);
    shear_mock_centre(m, stamp, &cx, &cy);
    for (int k = 0; k < n; k++) {
        u[k] += cx + 0.5 * (SIDE - 1);
        v[k] += cy + 0.5 * (SIDE - 1);
    }
    double amplitude = 1.0 - s->g1 * s->g1 - s->g2 * s->g2;
    int64_t psf = shear_mock_psf_of(m, stamp);
    assert_int_equal(shear_mock_paint(m, psf, n, u, v, amplitude, image, NULL), SHEAR_OK);
    make_stamps(m, stamp, 1, 1, &galaxy, &noise);
    for (int i = 0; i < PIXELS; i++)
        assert_close(galaxy[i], image[i], 1e-12 * image[i] + 1e-18);
    free(image);
    free(galaxy);
    free(noise);
}

static void test_psf_layouts(void **state) {
    (void)state;
    shear_mock *one = MOCK("size", "48");
    shear_mock *each = MOCK("size", "48", "psf-per-stamp", "yes", "stamps", "9");
    shear_mock *ids = MOCK("size", "48", "psf-ids", "3", "rotate", "2");
    assert_int_equal(shear_mock_get_info(one)->n_psf, 1);
    assert_int_equal(shear_mock_get_info(one)->psf_layout, SHEAR_PSF_ONE);
    assert_true(shear_mock_psf_angle(one, 0) == 30.0);
    assert_int_equal(shear_mock_get_info(each)->n_psf, 9);
    assert_int_equal(shear_mock_get_info(each)->psf_layout, SHEAR_PSF_PER_STAMP);
    assert_int_equal(shear_mock_psf_of(each, 5), 5);
    assert_int_equal(shear_mock_get_info(ids)->n_psf, 3);
    assert_int_equal(shear_mock_get_info(ids)->psf_layout, SHEAR_PSF_BY_ID);
    for (int i = 0; i < 12; i++) { /* rotated copies share a PSF */
        assert_int_equal(shear_mock_psf_of(ids, i), i / 2 % 3);
    }
    assert_true(shear_mock_psf_angle(ids, 0) != shear_mock_psf_angle(ids, 1));
    assert_in_range((uintmax_t)shear_mock_psf_angle(each, 2), 30, 210);
    for (int i = 3; i < 6; i++) {
        check_psf_of_stamp(one, i);
        check_psf_of_stamp(each, i);
        check_psf_of_stamp(ids, i);
    }
    shear_mock_free(one);
    shear_mock_free(each);
    shear_mock_free(ids);
}

static void test_bad_range(void **state) {
    (void)state;
    static const struct {
        int64_t first;
        int count;
    } bad[] = {{-1, 1}, {5, 2}, {6, 1}, {0, -1}, {INT64_MAX, 1}};
    shear_mock *m = MOCK("size", "48", "stamps", "6");
    double pixel = 0.0;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        shear_error err = {0};
        assert_int_equal(shear_mock_stamps(m, bad[i].first, bad[i].count, 1, &pixel, &pixel, &err),
                         SHEAR_E_SETTING);
        assert_non_null(strstr(err.message, "6 stamps"));
    }
    assert_int_equal(shear_mock_stamps(m, 6, 0, 1, &pixel, &pixel, NULL), SHEAR_OK);
    shear_mock_free(m);
    shear_mock_free(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_flux),
        cmocka_unit_test(test_position),
        cmocka_unit_test(test_shift),
        cmocka_unit_test(test_quarter_turn),
        cmocka_unit_test(test_threads_and_chunks),
        cmocka_unit_test(test_noise_does_not_know_the_shear),
        cmocka_unit_test(test_noises_do_not_know_each_other),
        cmocka_unit_test(test_galaxy_and_noise_stamps_differ),
        cmocka_unit_test(test_shared_noise),
        cmocka_unit_test(test_turned_stamps),
        cmocka_unit_test(test_psf_layouts),
        cmocka_unit_test(test_bad_range),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
