/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stamp pairs cut out of a chip: planes, masks, fills, flags. */
#include "chip_fixture.h"
#include "test.h"

#include "shear/stamp.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 400, STAMP = 32, N = STAMP * STAMP };
static const double R_GAL = 4.0; /* with R_PSF 1.5: light within 7.9 px */

static double mean_square(const double *v, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += v[i] * v[i];
    return sum / (double)n;
}

static void test_a_plane_is_subtracted(void **state) {
    (void)state;
    chip_pixels *flat = chip_new(SIDE, SIDE, 2.0, 1);
    chip_pixels *tilted = chip_new(SIDE, SIDE, 2.0, 1);
    for (int i = 0; i < SIDE * SIDE; i++)
        tilted->value[i] += 100.0 + 0.01 * (i % SIDE) - 0.02 * (double)(i / SIDE);
    const cutter_options options = chip_options(flat);
    cut_fixture a;
    cut_fixture b;
    cut_init(&a, flat, NULL, &options);
    cut_init(&b, tilted, NULL, &options);
    for (int i = 0; i < 20; i++) {
        assert_int_equal(cut_at(&a, 60.3 + 10 * i, 200.0, R_GAL, i), 0);
        assert_int_equal(cut_at(&b, 60.3 + 10 * i, 200.0, R_GAL, i), 0);
        assert_int_equal(a.pair.noise_x, b.pair.noise_x);
        for (int k = 0; k < N; k++) {
            assert_true(fabs(a.pair.galaxy[k] - b.pair.galaxy[k]) < 1e-9);
            assert_true(fabs(a.pair.noise[k] - b.pair.noise[k]) < 1e-9);
        }
        assert_true(fabs(b.pair.sigma - 2.0) < 0.1);
    }
    cut_deinit(&a);
    cut_deinit(&b);
    chip_free(flat);
    chip_free(tilted);
}

static void test_the_nearest_pixel_is_in_the_middle(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 2);
    cutter_options options = chip_options(c);
    for (options.stamp = 32; options.stamp <= 33; options.stamp++) {
        cut_fixture f;
        cut_init(&f, c, NULL, &options);
        const double offsets[] = {-0.5, 0.0, 0.49};
        for (int i = 0; i < 3; i++) {
            assert_int_equal(cut_at(&f, 100 + offsets[i], 150 + offsets[i], R_GAL, 1), 0);
            assert_int_equal(f.pair.x, 100 - options.stamp / 2);
            assert_int_equal(f.pair.y, 150 - options.stamp / 2);
        }
        cut_deinit(&f);
    }
    chip_free(c);
}

/* What is masked in either stamp is replaced in both, and nothing else. */
static void test_the_union_is_filled_in_both(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 2.0, 3);
    const cutter_options options = chip_options(c);
    cut_fixture plain;
    cut_init(&plain, c, NULL, &options);
    assert_int_equal(cut_at(&plain, 200, 200, R_GAL, 5), 0);
    assert_true(plain.pair.filled == 0.0);
    const int dx = plain.pair.noise_x - plain.pair.x;
    const int dy = plain.pair.noise_y - plain.pair.y;
    chip_damage(c, 185, 190, 1, 3, PIXEL_BAD);           /* the galaxy's */
    chip_damage(c, 214 + dx, 200 + dy, 2, 2, PIXEL_BAD); /* its noise stamp's */
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    assert_int_equal(cut_at(&f, 200, 200, R_GAL, 5), 0);
    assert_int_equal(f.pair.noise_x, plain.pair.noise_x);
    int changed = 0;
    for (int i = 0; i < N; i++) {
        const int x = i % STAMP + f.pair.x;
        const int y = i / STAMP + f.pair.y;
        const bool masked =
            (x == 185 && y >= 190 && y < 193) || (x >= 214 && x < 216 && y >= 200 && y < 202);
        changed += masked;
        assert_int_equal(fabs(f.pair.galaxy[i] - plain.pair.galaxy[i]) > 1e-9, masked);
        assert_int_equal(fabs(f.pair.noise[i] - plain.pair.noise[i]) > 1e-9, masked);
        assert_true(fabs(f.pair.galaxy[i]) < 15.0 && fabs(f.pair.noise[i]) < 15.0);
    }
    assert_int_equal(changed, 7);
    assert_true(f.pair.filled == 7.0 / N);
    cut_deinit(&plain);
    cut_deinit(&f);
    chip_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_plane_is_subtracted),
        cmocka_unit_test(test_the_nearest_pixel_is_in_the_middle),
        cmocka_unit_test(test_the_union_is_filled_in_both),
    };
    (void)mean_square;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
