/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Cramer-Rao bound of distributions where it is known. */
#include "engine/information.h"
#include "pair.h"
#include "test.h"

#include <math.h>

static double gaussian(uint64_t *seed) {
    return sqrt(-2.0 * log(1.0 - uniform(seed))) * cos(2.0 * M_PI * uniform(seed));
}

static void assert_about(double measured, double known) {
    if (!(fabs(measured / known - 1.0) < 0.02))
        fail_msg("the bound is %.5f, not %.5f", measured, known);
}

/* A Gaussian's information is 1 / sigma^2, of one component and of both. */
static void test_gaussian(void **state) {
    (void)state;
    static shape_counts counts;
    uint64_t seed = 1;
    counts = (shape_counts){0};
    for (int i = 0; i < 200000; i++)
        shape_counts_add(&counts, 1.0, 0.2 * gaussian(&seed), 0.2 * gaussian(&seed));
    assert_about(shape_bound_line(&counts), 0.2);
    assert_about(shape_bound_plane(&counts), 0.2);
}

/* Two kinds of galaxies that D tells apart: the mean of their informations, not the information of
 * their mixture. */
static void test_classes(void **state) {
    (void)state;
    static shape_counts known;
    static shape_counts mixed;
    uint64_t seed = 2;
    known = mixed = (shape_counts){0};
    for (int i = 0; i < 400000; i++) {
        const double sigma = i % 2 ? 0.15 : 0.3;
        const double e1 = sigma * gaussian(&seed);
        const double e2 = sigma * gaussian(&seed);
        shape_counts_add(&known, i % 2 ? 2.0 : 0.5, e1, e2);
        shape_counts_add(&mixed, 1.0, e1, e2);
    }
    const double mean = 0.5 / (0.15 * 0.15) + 0.5 / (0.3 * 0.3);
    assert_about(shape_bound_line(&known), 1.0 / sqrt(mean));
    assert_true(shape_bound_line(&mixed) > 1.05 / sqrt(mean));
}

/* p = 3 (1 - (e/a)^2)^2 / (pi a^2) in the plane: half the integral of |grad p|^2 / p is 12 / a^2.
 */
static void test_plane(void **state) {
    (void)state;
    static shape_counts counts;
    uint64_t seed = 3;
    counts = (shape_counts){0};
    for (int i = 0; i < 400000;) {
        const double x = 2.0 * uniform(&seed) - 1.0;
        const double y = 2.0 * uniform(&seed) - 1.0;
        const double rest = 1.0 - x * x - y * y;
        if (rest > 0.0 && uniform(&seed) < rest * rest) {
            shape_counts_add(&counts, 1.0, 0.8 * x, 0.8 * y);
            i++;
        }
    }
    assert_about(shape_bound_plane(&counts), 0.8 / sqrt(12.0));
    assert_true(shape_bound_line(&counts) > shape_bound_plane(&counts));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gaussian),
        cmocka_unit_test(test_classes),
        cmocka_unit_test(test_plane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
