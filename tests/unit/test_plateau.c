/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws of shot_noise=plateau: flat power is subtracted exactly, and the rest of white noise
 * averages out. */
#include "measure/plateau.h"

#include "base/cleanup.h"
#include "gaussian.h"
#include "oracle.h"
#include "pair.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void draw(pair *p, int nx, int ny, const char *shot_noise) {
    pair_init(p, nx, ny, 21, 21, 1);
    pair_draw(p, 1.4, 11);
    pair_set(p, "interpolation", "none");
    pair_set(p, "beta-ratio", "1.5");
    pair_set(p, "shot-noise", shot_noise);
}

static const int sides[][2] = {{16, 16}, {24, 17}, {31, 40}, {9, 8}};
enum { N_SIDES = sizeof sides / sizeof sides[0] };

static void test_oracle(void **state) {
    (void)state;
    for (int k = 0; k < N_SIDES; k++) {
        for (int filtered = 0; filtered < 2; filtered++) {
            for (int corrected = 0; corrected < 2; corrected++) {
                pair p;
                shear_plan_info info;
                double k_cut;
                draw(&p, sides[k][0], sides[k][1], "plateau");
                pair_set(&p, "noise-correction", corrected != 0 ? "yes" : "no");
                pair_set(&p, "core", filtered != 0 ? "2.5" : "auto");
                pair_set(&p, "width", filtered != 0 ? "0.8" : "auto");
                const shear_row measured = pair_measure_info(&p, &info);
                const shear_row expected =
                    oracle_measure(&info, &p.settings, p.galaxy, p.noise, p.psf, &k_cut);
                assert_rows_near(&measured, &expected, 1e-10);
                pair_set(&p, "shot-noise", "none");
                const shear_row left = pair_measure(&p);
                assert_true(fabs(left.m4 - measured.m4) > 1e-6 * left.m4);
                pair_deinit(&p);
            }
        }
    }
}

/* One bright pixel has the same power at every mode: as a noise stamp it is as good as none. */
static void test_one_pixel_of_noise(void **state) {
    (void)state;
    for (int k = 0; k < N_SIDES; k++) {
        pair p;
        const size_t pixels = (size_t)sides[k][0] * (size_t)sides[k][1];
        draw(&p, sides[k][0], sides[k][1], "plateau");
        memset(p.noise, 0, pixels * sizeof *p.noise);
        const shear_row without = pair_measure(&p);
        p.noise[pixels / 2 + 3] = 0.7;
        const shear_row with = pair_measure(&p);
        assert_rows_near(&with, &without, 1e-11);
        pair_set(&p, "shot-noise", "none");
        const shear_row left = pair_measure(&p);
        assert_true(fabs(left.m4 - with.m4) > 1e-4 * with.m4);
        pair_deinit(&p);
    }
}

/* As a galaxy stamp it has no moments. */
static void test_one_pixel_of_galaxy(void **state) {
    (void)state;
    pair p;
    draw(&p, 24, 17, "none");
    memset(p.galaxy, 0, 24 * 17 * sizeof *p.galaxy);
    memset(p.noise, 0, 24 * 17 * sizeof *p.noise);
    p.galaxy[100] = 3.0;
    const shear_row left = pair_measure(&p);
    pair_set(&p, "shot-noise", "plateau");
    const shear_row none = pair_measure(&p);
    assert_true(left.m4 > 0.0 && fabs(none.m4) < 1e-13 * left.m4);
    assert_true(fabs(none.m20) < 1e-13 * left.m20 && fabs(none.m02) < 1e-13 * left.m02);
    assert_true(fabs(none.m11) < 1e-13 * left.m20 && fabs(none.u) < 1e-13 * left.m4);
    pair_deinit(&p);
}

/* A number of unit variance and zero mean: twelve uniform ones summed. */
static double normal(uint64_t *seed) {
    double sum = -6.0;
    for (int i = 0; i < 12; i++)
        sum += uniform(seed);
    return sum;
}

typedef struct mean {
    double sum, squares;
} mean;

static void add(mean *m, double x) {
    m->sum += x;
    m->squares += x * x;
}

/* White noise of more variance in the galaxy stamp than in the noise stamp: on average the plateau
 * restores the moments of a stamp without noise, which are far away without it. */
static void test_expectation(void **state) {
    (void)state;
    enum { SIDE = 32, TRIES = 400 };
    uint64_t seed = 5;
    double clean[SIDE * SIDE];
    pair p;
    draw(&p, SIDE, SIDE, "none");
    for (int i = 0; i < SIDE * SIDE; i++) { /* broad enough to have no power at the plateau */
        const double x = i % SIDE - 15.2;
        const double y = i / SIDE - 15.9;
        clean[i] = p.galaxy[i] = exp(-(x * x + 0.3 * x * y + 1.3 * y * y) / 12.0);
        p.noise[i] = 0.0;
    }
    const shear_row truth = pair_measure(&p);
    mean n1 = {0};
    mean d = {0};
    mean uncorrected = {0};
    for (int t = 0; t < TRIES; t++) {
        for (int i = 0; i < SIDE * SIDE; i++) {
            p.galaxy[i] = clean[i] + 0.04 * normal(&seed);
            p.noise[i] = 0.02 * normal(&seed);
        }
        pair_set(&p, "shot-noise", "plateau");
        const shear_row row = pair_measure(&p);
        add(&n1, row.n1 - truth.n1);
        add(&d, row.d - truth.d);
        pair_set(&p, "shot-noise", "none");
        add(&uncorrected, pair_measure(&p).d - truth.d);
    }
    assert_true(fabs(n1.sum) < 4.0 * sqrt(n1.squares));
    assert_true(fabs(d.sum) < 4.0 * sqrt(d.squares));
    assert_true(fabs(uncorrected.sum) > 10.0 * sqrt(d.squares));
    pair_deinit(&p);
}

/* The modes counted, by the definition in rounded numbers away from the circle itself. */
static void test_count(void **state) {
    (void)state;
    for (int k = 0; k < N_SIDES; k++) {
        plateau p;
        const int nx = sides[k][0];
        const int ny = sides[k][1];
        int n = 0;
        arena a = {.used = 1 << 22};
        CLEANUP(release_free) void *memory = arena_allocate(&a);
        plateau_place(&p, nx, ny, &a);
        for (int jy = -(ny / 2); jy <= (ny - 1) / 2; jy++) {
            for (int jx = -(nx / 2); jx <= (nx - 1) / 2; jx++)
                n += hypot((double)jx / nx, (double)jy / ny) > 0.375 + 1e-9;
        }
        assert_true(p.n == n);
    }
}

static void test_refused_with_interpolation(void **state) {
    (void)state;
    pair p;
    shear_row row;
    shear_error err = {0};
    pair_init(&p, 16, 16, 15, 15, 1);
    pair_draw(&p, 0.7, 3);
    pair_set(&p, "interpolation", "paper"); /* interpolates */
    pair_set(&p, "shot-noise", "plateau");
    assert_int_equal(pair_try(&p, &row, &err), SHEAR_E_SETTING);
    assert_non_null(strstr(err.message, "shot-noise"));
    assert_true(err.advice[0] != '\0');
    pair_set(&p, "interpolation", "bicubic");
    assert_int_equal(pair_try(&p, &row, &err), SHEAR_E_SETTING);
    pair_deinit(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_oracle),
        cmocka_unit_test(test_one_pixel_of_noise),
        cmocka_unit_test(test_one_pixel_of_galaxy),
        cmocka_unit_test(test_expectation),
        cmocka_unit_test(test_count),
        cmocka_unit_test(test_refused_with_interpolation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
