/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether light is where positions are: galaxies at any distance, noise without galaxies, origins.
 */
#include "shear/centring.h"
#include "sheard/advice.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 40, MANY = 200 };

static double galaxy[SIDE * SIDE], noise[SIDE * SIDE];

static uint64_t seed;
static double uniform(void) {
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return ((double)(seed >> 11) + 0.5) * 0x1p-53;
}
static double normal(void) {
    return sqrt(-2.0 * log(uniform())) * cos(6.283185307179586 * uniform());
}

static void assert_near(double a, double b, double tolerance) {
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.12g is not %.12g within %g", a, b, tolerance);
}

/* A galaxy of sigma 2 px at a distance from the middle pixel; noise of standard deviation 1. */
static void draw(int side, double peak, double x, double y) {
    for (int j = 0; j < side; j++) {
        for (int i = 0; i < side; i++) {
            const double dx = i - side / 2 - x;
            const double dy = j - side / 2 - y;
            galaxy[j * side + i] = peak * exp(-0.125 * (dx * dx + dy * dy)) + normal();
            noise[j * side + i] = normal();
        }
    }
}

static bool find(int side, double x, double y, double *dx, double *dy) {
    const shear_stamps s = {.count = 1, .nx = side, .ny = side, .galaxy = galaxy, .noise = noise};
    return shear_centring_find(&s, 0, x, y, dx, dy);
}

/* A sample of galaxies whose positions are wrong by (x, y). */
static shear_centring sample(double peak, double x, double y) {
    static double dx[MANY], dy[MANY];
    shear_centring c;
    int n = 0;
    seed = 3;
    for (int i = 0; i < MANY; i++) {
        const double at_x = 100.0 * uniform();
        const double at_y = 100.0 * uniform();
        draw(SIDE, peak, at_x - floor(at_x + 0.5) + x, at_y - floor(at_y + 0.5) + y);
        n += find(SIDE, at_x, at_y, &dx[n], &dy[n]);
    }
    shear_centring_summarize(&c, MANY, dx, dy, n);
    return c;
}

static void test_distances(void **state) {
    double dx = 0.0;
    double dy = 0.0;
    (void)state;
    for (int side = 8; side <= SIDE; side++) { /* also odd ones, and the smallest stamps */
        const double reach = side < 20 ? 0.5 : 5.0;
        draw(side, 1e6, reach, -0.6 * reach);
        assert_true(find(side, 12.0, 7.0, &dx, &dy));
        assert_near(dx, reach, 0.15);
        assert_near(dy, -0.6 * reach, 0.15);
    }
}

static void test_the_fraction_of_a_position_counts(void **state) {
    double dx = 0.0;
    double dy = 0.0;
    (void)state;
    draw(SIDE, 1e6, 0.3, -0.4);
    assert_true(find(SIDE, 12.3, 6.6, &dx, &dy));
    assert_near(dx, 0.0, 0.05);
    assert_near(dy, 0.0, 0.05);
}

static void test_right_positions(void **state) {
    static const double peaks[] = {1.5, 3.0, 10.0, 1000.0};
    char line[SHEARD_ADVICE_SIZE];
    (void)state;
    for (size_t k = 0; k < sizeof peaks / sizeof peaks[0]; k++) {
        const shear_centring c = sample(peaks[k], 0.0, 0.0);
        assert_false(shear_centring_is_off(&c));
        assert_false(shear_centring_is_lost(&c));
        assert_null(sheard_advice_positions(&c, line, sizeof line));
        assert_true(fabs(c.x) < 5.0 * c.x_err && fabs(c.y) < 5.0 * c.y_err);
    }
}

static void test_origins(void **state) {
    char line[SHEARD_ADVICE_SIZE];
    (void)state;
    for (int sign = -1; sign <= 1; sign += 2) {
        const shear_centring c = sample(5.0, sign, sign);
        assert_near(c.x, sign, 0.15);
        assert_true(shear_centring_is_off(&c));
        assert_non_null(sheard_advice_positions(&c, line, sizeof line));
        assert_non_null(strstr(line, sign > 0 ? "--origin 0" : "--origin 1"));
    }
    const shear_centring other = sample(5.0, 3.0, 0.0);
    assert_non_null(sheard_advice_positions(&other, line, sizeof line));
    assert_null(strstr(line, "--origin"));
    assert_non_null(strstr(line, "another image"));
}

/* Cosmic rays without their mask, or the galaxies of another chip: light anywhere. */
static void test_light_by_chance(void **state) {
    static double dx[MANY], dy[MANY];
    char line[SHEARD_ADVICE_SIZE];
    (void)state;
    for (int found = 12; found <= MANY; found += 47) {
        shear_centring c;
        seed = 5;
        for (int i = 0; i < found; i++) {
            dx[i] = 16.0 * uniform() - 8.0;
            dy[i] = 16.0 * uniform() - 8.0;
        }
        shear_centring_summarize(&c, found < 64 ? 64 : MANY, dx, dy, found);
        assert_true(shear_centring_is_lost(&c));
        assert_non_null(sheard_advice_positions(&c, line, sizeof line));
        assert_non_null(strstr(line, "by chance"));
    }
}

static void test_no_light(void **state) {
    char line[SHEARD_ADVICE_SIZE];
    const shear_centring c = sample(0.0, 0.0, 0.0);
    (void)state;
    assert_false(shear_centring_is_off(&c));
    assert_true(shear_centring_is_lost(&c));
    assert_non_null(strstr(sheard_advice_positions(&c, line, sizeof line), "positions only"));
}

static void test_hostile_stamps(void **state) {
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1e308, -1e308, 0.0};
    double dx = 0.0;
    double dy = 0.0;
    (void)state;
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        for (int i = 0; i < SIDE * SIDE; i++)
            galaxy[i] = noise[i] = bad[k];
        if (find(SIDE, 1e300, NAN, &dx, &dy))
            fail_msg("light in stamps of %g", bad[k]);
        assert_true(dx == 0.0 && dy == 0.0);
    }
    shear_centring none;
    shear_centring_summarize(&none, 0, NULL, NULL, 0);
    assert_true(none.looked_at == 0 && isnan(none.x) && isnan(none.y_err));
    assert_false(shear_centring_is_off(&none) || shear_centring_is_lost(&none));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_distances),
        cmocka_unit_test(test_the_fraction_of_a_position_counts),
        cmocka_unit_test(test_right_positions),
        cmocka_unit_test(test_origins),
        cmocka_unit_test(test_light_by_chance),
        cmocka_unit_test(test_no_light),
        cmocka_unit_test(test_hostile_stamps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
