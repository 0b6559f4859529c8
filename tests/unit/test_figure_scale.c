/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws of ticks, ranges, stretches, histograms and colours. */
#include "test.h"

#include "shear_figures/scale.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A fixed sequence of numbers in [0, 1). */
static double draw(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 9007199254740992.0;
}

/* ---- ticks ---- */

static size_t multiples_within(double step, double lo, double hi) {
    return (size_t)(floor(hi / step + 1e-9) - ceil(lo / step - 1e-9) + 1.0);
}

/* The mantissa 1, 2 or 5 of a step; 0 for any other number. */
static int mantissa_of(double step) {
    const double mantissa = step / pow(10.0, floor(log10(step) + 1e-9));
    const long digit = lround(mantissa);
    return fabs(mantissa - (double)digit) < 1e-6 && (digit == 1 || digit == 2 || digit == 5)
               ? (int)digit
               : 0;
}

/* The number that a label shows: its minus is U+2212, its factor 10^exponent. */
static double number_of(const char *label, int exponent) {
    const bool negative = strncmp(label, "\xe2\x88\x92", 3) == 0;
    const double value = strtod(label + (negative ? 3 : 0), NULL);
    return (negative ? -value : value) * pow(10.0, exponent);
}

static void check_linear(double lo, double hi, int at_most) {
    shear_ticks t;
    shear_ticks_linear(&t, lo, hi, at_most);
    assert_in_range(t.n, 1, at_most);
    for (int i = 0; i < t.n; i++)
        assert_true(t.at[i] >= lo - 1e-8 * (hi - lo) && t.at[i] <= hi + 1e-8 * (hi - lo));
    if (t.n < 2)
        return;
    const double step = (t.at[t.n - 1] - t.at[0]) / (t.n - 1);
    const int mantissa = mantissa_of(step);
    assert_int_not_equal(mantissa, 0);
    assert_int_equal(t.n, multiples_within(step, lo, hi)); /* to both ends */
    const double finer = step * (mantissa == 5 ? 0.4 : 0.5);
    assert_true(multiples_within(finer, lo, hi) > (size_t)at_most);
    for (int i = 0; i < t.n; i++) {
        assert_true(fabs(t.at[i] / step - round(t.at[i] / step)) < 1e-6);
        assert_true(fabs(number_of(t.label[i], t.exponent) - t.at[i]) < 1e-6 * step);
    }
}

static void test_linear_ticks_are_the_finest_round_ones(void **state) {
    (void)state;
    uint64_t seed = 1;
    for (int i = 0; i < 4000; i++) {
        const double width = pow(10.0, 12.0 * draw(&seed) - 6.0);
        const double lo = (2.0 * draw(&seed) - 1.5) * width;
        check_linear(lo, lo + width, 2 + (int)(15.0 * draw(&seed)));
    }
    check_linear(0.0, 1.0, 6);
    check_linear(-1e300, 1e300, 9);
    check_linear(0.0, 3e-300, 5);
}

static void test_ends_that_are_ticks_are_drawn(void **state) {
    (void)state;
    shear_ticks t;
    shear_ticks_linear(&t, -0.3, 0.3, 7);
    assert_int_equal(t.n, 7);
    assert_string_equal(t.label[0], "\xe2\x88\x92"
                                    "0.3");
    assert_string_equal(t.label[3], "0.0");
    assert_string_equal(t.label[6], "0.3");
    assert_int_equal(t.exponent, 0);
}

static void test_small_and_large_ticks_share_a_power(void **state) {
    (void)state;
    shear_ticks t;
    shear_ticks_linear(&t, 0.0, 4e-7, 5);
    assert_int_equal(t.exponent, -7);
    assert_string_equal(t.label[t.n - 1], "4");
    shear_ticks_linear(&t, 0.0, 2.5e8, 6);
    assert_int_equal(t.exponent, 8);
    assert_string_equal(t.label[t.n - 1], "2.5");
}

static void test_impossible_axes_have_no_ticks(void **state) {
    (void)state;
    static const double bad[][2] = {{1, 1},        {2, 1},         {NAN, 1},
                                    {0, INFINITY}, {-INFINITY, 0}, {-DBL_MAX, DBL_MAX}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        shear_ticks t = {.n = 3};
        shear_ticks_linear(&t, bad[i][0], bad[i][1], 5);
        assert_int_equal(t.n, 0);
    }
    static const double bad_log[][2] = {{0, 1}, {-1, 1}, {1, 1}, {1, INFINITY}, {NAN, 1}};
    for (size_t i = 0; i < sizeof bad_log / sizeof bad_log[0]; i++) {
        shear_ticks t = {.n = 3};
        shear_ticks_log(&t, bad_log[i][0], bad_log[i][1], 5);
        assert_int_equal(t.n, 0);
    }
}

static void test_log_ticks_lie_within_and_are_few(void **state) {
    (void)state;
    uint64_t seed = 2;
    for (int i = 0; i < 2000; i++) {
        const double lo = pow(10.0, 40.0 * draw(&seed) - 20.0);
        const double hi = lo * pow(10.0, 0.02 + 20.0 * draw(&seed) * draw(&seed));
        const int at_most = 2 + (int)(8.0 * draw(&seed));
        shear_ticks t;
        shear_ticks_log(&t, lo, hi, at_most);
        assert_in_range(t.n, 1, at_most);
        for (int k = 0; k < t.n; k++) {
            assert_true(t.at[k] >= lo * (1 - 1e-8) && t.at[k] <= hi * (1 + 1e-8));
            assert_true(k == 0 || t.at[k] > t.at[k - 1]);
        }
    }
}

static void test_log_ticks_by_length_of_the_axis(void **state) {
    (void)state;
    shear_ticks t;
    shear_ticks_log(&t, 1e-3, 1e2, 8); /* decades */
    assert_int_equal(t.n, 6);
    assert_string_equal(t.label[0], "10^{\xe2\x88\x92"
                                    "3}");
    assert_string_equal(t.label[5], "10^{2}");
    shear_ticks_log(&t, 1e-8, 1.0, 5); /* every second */
    assert_int_equal(t.n, 5);
    assert_true(fabs(log10(t.at[0]) + 8.0) < 1e-9 && fabs(log10(t.at[1]) + 6.0) < 1e-9);
    shear_ticks_log(&t, 3.0, 80.0, 8); /* 5, 10, 20, 50 */
    assert_int_equal(t.n, 4);
    assert_string_equal(t.label[0], "5");
    assert_string_equal(t.label[3], "50");
    shear_ticks_log(&t, 6.0, 7.0, 6); /* as linear ones */
    assert_true(t.n >= 3);
    assert_string_equal(t.label[0], "6.0");
}

static void test_stretch_ticks_keep_their_distance(void **state) {
    (void)state;
    for (enum shear_stretch_kind kind = SHEAR_LINEAR; kind <= SHEAR_LOG; kind++) {
        const shear_stretch s = shear_stretch_make(kind, (shear_range){-3.0, 4321.0}, 2.0);
        shear_ticks t;
        shear_ticks_stretch(&t, &s, 7);
        assert_in_range(t.n, 2, 8);
        for (int i = 1; i < t.n; i++) {
            const double apart =
                shear_stretch_apply(&s, t.at[i]) - shear_stretch_apply(&s, t.at[i - 1]);
            assert_true(apart >= 1.0 / 7.0 - 1e-9);
        }
    }
}

/* ---- ranges ---- */

static void test_percentiles_of_a_ramp(void **state) {
    (void)state;
    double v[105];
    for (int i = 0; i <= 100; i++) {
        v[i] = (i * 37) % 101; /* 0 .. 100, shuffled */
    }
    v[101] = NAN;
    v[102] = INFINITY;
    v[103] = -INFINITY;
    v[104] = NAN;
    shear_range r;
    assert_int_equal(shear_range_percentile(&r, v, 105, 2.5, 97.5, NULL), SHEAR_OK);
    assert_true(fabs(r.lo - 2.5) < 1e-12 && fabs(r.hi - 97.5) < 1e-12);
    assert_int_equal(shear_range_percentile(&r, v, 105, 0.0, 100.0, NULL), SHEAR_OK);
    assert_true(r.lo == 0.0 && r.hi == 100.0);
    const shear_range all = shear_range_of(v, 105);
    assert_true(all.lo == 0.0 && all.hi == 100.0);
}

static void test_percentiles_of_nothing(void **state) {
    (void)state;
    const double v[2] = {NAN, INFINITY};
    shear_range r;
    assert_int_equal(shear_range_percentile(&r, v, 2, 1.0, 99.0, NULL), SHEAR_OK);
    assert_true(isnan(r.lo) && isnan(r.hi));
    assert_int_equal(shear_range_percentile(&r, NULL, 0, 1.0, 99.0, NULL), SHEAR_OK);
    assert_true(isnan(r.lo) && isnan(r.hi));
    assert_true(isnan(shear_range_of(NULL, 0).lo));
    shear_error err = {0};
    assert_int_equal(shear_range_percentile(&r, v, SIZE_MAX, 1.0, 99.0, &err), SHEAR_E_NOMEM);
    assert_int_equal(err.code, SHEAR_E_NOMEM);
}

static void test_padded_ranges_can_be_drawn(void **state) {
    (void)state;
    const shear_range odd[] = {{NAN, NAN}, {3.0, 3.0}, {0.0, 0.0}, {5.0, -5.0}, {1.0, INFINITY}};
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++) {
        const shear_range r = shear_range_pad(odd[i], 0.1);
        assert_true(isfinite(r.lo) && isfinite(r.hi) && r.lo < r.hi);
    }
    const shear_range r = shear_range_pad((shear_range){1.0, 3.0}, 0.25);
    assert_true(fabs(r.lo - 0.5) < 1e-15 && fabs(r.hi - 3.5) < 1e-15);
    const shear_range joined = shear_range_join((shear_range){1.0, 2.0}, (shear_range){NAN, NAN});
    assert_true(joined.lo == 1.0 && joined.hi == 2.0);
}

static void test_histogram_counts_every_value_once(void **state) {
    (void)state;
    const double v[] = {0.0, 0.99, 1.0, 2.5, 3.0, 4.0, -0.1, 4.1, NAN, INFINITY};
    double counts[4];
    const size_t outside = shear_histogram(counts, 4, (shear_range){0.0, 4.0}, v, 10);
    assert_int_equal(outside, 2);
    const double expected[4] = {2.0, 1.0, 1.0, 2.0}; /* the last bin is closed */
    assert_memory_equal(counts, expected, sizeof counts);
}

/* ---- stretches ---- */

static void check_monotonic(const shear_stretch *s) {
    const double width = s->span.hi - s->span.lo;
    double before = 0.0;
    for (int i = 0; i <= 3000; i++) {
        const double value = s->span.lo - 0.25 * width + width * 1.5 * i / 3000.0;
        const double t = shear_stretch_apply(s, value);
        assert_true(t >= before && t <= 1.0);
        before = t;
    }
    assert_true(fabs(shear_stretch_apply(s, s->span.lo)) < 1e-14);
    assert_true(fabs(shear_stretch_apply(s, s->span.hi) - 1.0) < 1e-14);
    assert_true(isnan(shear_stretch_apply(s, NAN)));
    assert_true(shear_stretch_apply(s, INFINITY) == 1.0);
    assert_true(shear_stretch_apply(s, -INFINITY) == 0.0);
}

static void test_stretches_never_decrease(void **state) {
    (void)state;
    static const shear_range spans[] = {{-2.0, 1000.0}, {1e-6, 1.0}, {-1e-9, 1e-9}, {7.0, 8.0}};
    for (enum shear_stretch_kind kind = SHEAR_LINEAR; kind <= SHEAR_LOG; kind++) {
        for (size_t i = 0; i < sizeof spans / sizeof spans[0]; i++) {
            const shear_stretch s = shear_stretch_make(kind, spans[i], 0.0);
            check_monotonic(&s);
        }
    }
}

static void test_stretches_at_known_values(void **state) {
    (void)state;
    const shear_stretch linear = shear_stretch_make(SHEAR_LINEAR, (shear_range){-2.0, 6.0}, 0.0);
    assert_true(fabs(shear_stretch_apply(&linear, 0.0) - 0.25) < 1e-15);
    const shear_stretch decades = shear_stretch_make(SHEAR_LOG, (shear_range){1e-3, 1e1}, 0.0);
    assert_true(fabs(shear_stretch_apply(&decades, 1e-2) - 0.25) < 1e-14);
    assert_true(shear_stretch_apply(&decades, -5.0) == 0.0);
    const shear_stretch both = shear_stretch_make(SHEAR_ASINH, (shear_range){-9.0, 9.0}, 0.5);
    assert_true(fabs(shear_stretch_apply(&both, 0.0) - 0.5) < 1e-15);
    const double at_2 = 0.5 + 0.5 * asinh(2.0 / 0.5) / asinh(9.0 / 0.5);
    assert_true(fabs(shear_stretch_apply(&both, 2.0) - at_2) < 1e-14);
}

static void test_any_span_makes_a_stretch(void **state) {
    (void)state;
    const shear_range odd[] = {{NAN, NAN}, {0.0, 0.0},  {-4.0, -1.0},
                               {5.0, 5.0}, {-3.0, 0.0}, {NAN, 2.0}};
    for (enum shear_stretch_kind kind = SHEAR_LINEAR; kind <= SHEAR_LOG; kind++) {
        for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++) {
            const shear_stretch s = shear_stretch_make(kind, odd[i], NAN);
            assert_true(s.span.lo < s.span.hi);
            check_monotonic(&s);
        }
    }
}

/* ---- colours ---- */

static double linear_of(double v) {
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

/* CIE lightness, 0 to 100: another measure than the one the maps are made with. */
static double lightness(shear_colour c) {
    const double y = 0.2126 * linear_of(c.r) + 0.7152 * linear_of(c.g) + 0.0722 * linear_of(c.b);
    return y > 0.008856 ? 116.0 * cbrt(y) - 16.0 : 903.3 * y;
}

static void test_maps_grow_lighter_in_even_steps(void **state) {
    (void)state;
    for (enum shear_map map = SHEAR_MAP_UNIFORM; map <= SHEAR_MAP_GREY; map++) {
        const double whole =
            lightness(shear_map_colour(map, 1.0)) - lightness(shear_map_colour(map, 0.0));
        assert_true(whole > 80.0);
        for (int i = 0; i < 40; i++) {
            const double step = lightness(shear_map_colour(map, (i + 1) / 40.0)) -
                                lightness(shear_map_colour(map, i / 40.0));
            /* CIELAB and OKLab differ by some 30 % locally; in the darkest grey CIELAB turns
             * linear. */
            assert_true(step > 0.0 && step < 1.6 * whole / 40.0);
        }
    }
}

static void test_maps_clamp(void **state) {
    (void)state;
    const shear_colour low = shear_map_colour(SHEAR_MAP_UNIFORM, 0.0);
    const shear_colour below = shear_map_colour(SHEAR_MAP_UNIFORM, -3.0);
    const shear_colour none = shear_map_colour(SHEAR_MAP_UNIFORM, NAN);
    assert_memory_equal(&low, &below, sizeof low);
    assert_memory_equal(&low, &none, sizeof low);
    const shear_colour high = shear_map_colour(SHEAR_MAP_GREY, 7.0);
    assert_true(high.r > 0.999 && high.g > 0.999 && high.b > 0.999);
}

static double distance(shear_colour a, shear_colour b) {
    return fabs(a.r - b.r) + fabs(a.g - b.g) + fabs(a.b - b.b);
}

static void test_palette_wraps_and_differs(void **state) {
    (void)state;
    for (int i = 0; i < SHEAR_N_HUES; i++) {
        assert_true(distance(shear_palette(i), shear_palette(i + SHEAR_N_HUES)) == 0.0);
        assert_true(distance(shear_palette(i), shear_palette(i - SHEAR_N_HUES)) == 0.0);
        for (int j = 0; j < i; j++)
            assert_true(distance(shear_palette(i), shear_palette(j)) > 0.2);
    }
    assert_true(shear_palette_faint(SHEAR_BLUE, 0.25).a == 0.25);
}

/* The colours of pixels outside the scale must not be mistaken for any on it. */
static void test_marks_are_in_no_map(void **state) {
    (void)state;
    for (int i = 0; i <= 200; i++) {
        const shear_colour uniform = shear_map_colour(SHEAR_MAP_UNIFORM, i / 200.0);
        const shear_colour grey = shear_map_colour(SHEAR_MAP_GREY, i / 200.0);
        assert_true(distance(uniform, shear_map_not_finite()) > 0.3);
        assert_true(distance(grey, shear_map_not_finite()) > 0.3);
        assert_true(distance(grey, shear_map_negative()) > 0.3);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_linear_ticks_are_the_finest_round_ones),
        cmocka_unit_test(test_ends_that_are_ticks_are_drawn),
        cmocka_unit_test(test_small_and_large_ticks_share_a_power),
        cmocka_unit_test(test_impossible_axes_have_no_ticks),
        cmocka_unit_test(test_log_ticks_lie_within_and_are_few),
        cmocka_unit_test(test_log_ticks_by_length_of_the_axis),
        cmocka_unit_test(test_stretch_ticks_keep_their_distance),
        cmocka_unit_test(test_percentiles_of_a_ramp),
        cmocka_unit_test(test_percentiles_of_nothing),
        cmocka_unit_test(test_padded_ranges_can_be_drawn),
        cmocka_unit_test(test_histogram_counts_every_value_once),
        cmocka_unit_test(test_stretches_never_decrease),
        cmocka_unit_test(test_stretches_at_known_values),
        cmocka_unit_test(test_any_span_makes_a_stretch),
        cmocka_unit_test(test_maps_grow_lighter_in_even_steps),
        cmocka_unit_test(test_maps_clamp),
        cmocka_unit_test(test_palette_wraps_and_differs),
        cmocka_unit_test(test_marks_are_in_no_map),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
