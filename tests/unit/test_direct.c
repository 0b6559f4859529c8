/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The measurement against the oracle: every method, policy and option on small stamps. Agreement is
 * to 1e-10 of the moments' scale: both sum some thousand terms of double precision, divided by
 * |W|^2 down to the threshold of 1e-8. */
#include "gaussian.h"
#include "oracle.h"
#include "pair.h"
#include "test.h"

#include <math.h>

static const double tolerance = 1e-10;

static void check(const pair *p) {
    shear_plan_info info;
    const shear_row measured = pair_measure_info(p, &info);
    double k_cut;
    const shear_row expected =
        oracle_measure(&info, &p->settings, p->galaxy, p->noise, p->psf, &k_cut);
    assert_rows_near(&measured, &expected, tolerance);
    assert_near(info.k_cut, k_cut, 1e-14, k_cut, "k_cut");
}

typedef struct shape {
    int nx, ny, psf_nx, psf_ny, psf_oversample;
    double r_psf;
} shape;

static void draw(pair *p, const shape *s, uint64_t seed) {
    pair_init(p, s->nx, s->ny, s->psf_nx, s->psf_ny, s->psf_oversample);
    pair_draw(p, s->r_psf, seed);
    pair_set(p, "oversample", "4");
}

static const shape shapes[] = {{12, 10, 9, 9, 1, 0.8},
                               {9, 8, 11, 7, 1, 0.9},
                               {8, 13, 20, 23, 3, 0.7},
                               {11, 11, 16, 8, 1, 0.8}};
enum { N_SHAPES = sizeof shapes / sizeof shapes[0] };

static void test_every_method(void **state) {
    (void)state;
    for (int k = 0; k < N_SHAPES; k++) {
        for (int m = 1; m < PAIR_METHODS; m++) {
            pair p;
            draw(&p, &shapes[k], 17u + (uint64_t)k);
            pair_set(&p, "interpolation", pair_methods[m]);
            check(&p);
            pair_set(&p, "core", "3.2");
            pair_set(&p, "width", "1.1");
            check(&p);
            pair_set(&p, "background", "noise-mean");
            check(&p);
            pair_set(&p, "noise-correction", "no");
            check(&p);
            pair_deinit(&p);
        }
    }
}

static void test_no_interpolation(void **state) {
    (void)state;
    const shape plain[] = {{12, 10, 9, 9, 1, 1.1},
                           {9, 8, 11, 7, 1, 1.2},
                           {8, 13, 30, 25, 3, 1.1},
                           {31, 8, 40, 12, 1, 1.5}};
    for (int k = 0; k < 4; k++) {
        pair p;
        draw(&p, &plain[k], 99u + (uint64_t)k);
        pair_set(&p, "oversample", "auto");
        pair_set(&p, "interpolation", "none");
        check(&p);
        pair_set(&p, "filter", "edge");
        pair_set(&p, "width", "0.8");
        check(&p);
        pair_set(&p, "background", "noise-mean");
        check(&p);
        pair_deinit(&p);
    }
}

/* Zeros strewn over the stamps, in every tenth pixel and in one corner. */
static void punch_zeros(pair *p, uint64_t seed) {
    for (int y = 0; y < p->geometry.ny; y++) {
        for (int x = 0; x < p->geometry.nx; x++) {
            const int i = y * p->geometry.nx + x;
            const bool corner = x + y < 5;
            p->galaxy[i] = corner || uniform(&seed) < 0.1 ? 0.0 : p->galaxy[i];
            p->noise[i] = corner || uniform(&seed) < 0.1 ? 0.0 : p->noise[i];
        }
    }
}

static void test_zeros(void **state) {
    (void)state;
    static const char *const policies[] = {"skip", "floor"};
    for (int m = 4; m < PAIR_METHODS; m++) {
        for (int policy = 0; policy < 2; policy++) {
            pair p;
            draw(&p, &shapes[policy], 5u + (uint64_t)m);
            punch_zeros(&p, 77u + (uint64_t)m);
            pair_set(&p, "interpolation", pair_methods[m]);
            pair_set(&p, "zeros", policies[policy]);
            check(&p);
            pair_set(&p, "filter", "edge");
            pair_set(&p, "width", "0.7");
            check(&p);
            pair_deinit(&p);
        }
    }
}

static void test_pedestal(void **state) {
    (void)state;
    for (int m = 4; m < PAIR_METHODS; m++) {
        pair p;
        draw(&p, &shapes[m % N_SHAPES], 31u + (uint64_t)m);
        for (int i = 0; i < p.geometry.nx * p.geometry.ny; i++) {
            p.galaxy[i] -= 0.03;
            p.noise[i] -= 0.03;
        }
        p.noise[7] = -0.0625; /* exactly minus the pedestal: a zero of the logarithm */
        pair_set(&p, "interpolation", pair_methods[m]);
        pair_set(&p, "pedestal", "0.0625");
        check(&p);
        pair_set(&p, "core", "2.5"); /* a pedestal left on would show now */
        check(&p);
        pair_deinit(&p);
    }
}

/* A threshold that bites well inside the band, so that the cut decides. */
static void test_cut(void **state) {
    (void)state;
    static const char *const thresholds[] = {"1e-3", "1e-2", "0.05"};
    for (int i = 0; i < 3; i++) {
        pair p;
        draw(&p, &shapes[i], 3u + (uint64_t)i);
        pair_set(&p, "interpolation", "spline");
        pair_set(&p, "psf-threshold", thresholds[i]);
        pair_set(&p, "beta", "4");
        check(&p);
        pair_deinit(&p);
    }
}

/* One side of 8, another so long that only few of its columns are transformed. */
static void test_long_stamps(void **state) {
    (void)state;
    const shape tall = {8, 200, 9, 9, 1, 1.2};
    const shape broad = {200, 8, 9, 9, 1, 1.2};
    for (int i = 0; i < 2; i++) {
        pair p;
        draw(&p, i == 0 ? &tall : &broad, 1u);
        pair_set(&p, "oversample", "auto");
        pair_set(&p, "interpolation", "none");
        check(&p);
        pair_deinit(&p);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_method), cmocka_unit_test(test_no_interpolation),
        cmocka_unit_test(test_zeros),        cmocka_unit_test(test_pedestal),
        cmocka_unit_test(test_cut),          cmocka_unit_test(test_long_stamps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
