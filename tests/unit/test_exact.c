/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The exact accumulator: order, split and cancellation change no bit, and the sum is rounded once,
 * to nearest. */
#include "pair.h"
#include "test.h"

#include "exact/exact.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Any finite double: random sign, exponent from subnormal to largest, random mantissa. */
static double any_double(uint64_t *state) {
    const double fraction = 1.0 + uniform(state);
    const int exponent = (int)(2098.0 * uniform(state)) - 1074;
    return (uniform(state) < 0.5 ? -1.0 : 1.0) * ldexp(fraction, exponent);
}

static void assert_same_bits(double a, double b) {
    assert_memory_equal(&a, &b, sizeof a);
}

static void shuffle(double *x, int n, uint64_t *state) {
    for (int i = n - 1; i > 0; i--) {
        const int j = (int)((i + 1) * uniform(state));
        const double keep = x[i];
        x[i] = x[j];
        x[j] = keep;
    }
}

static double sum_of(const double *x, int n) {
    exact_sum *s = exact_new(1);
    assert_non_null(s);
    for (int i = 0; i < n; i++)
        exact_add(s, 0, x[i]);
    const double value = exact_value(s, 0);
    exact_free(s, 1);
    return value;
}

enum { N = 400 };

static void test_order(void **state) {
    (void)state;
    uint64_t seed = 1;
    double x[N];
    for (int trial = 0; trial < 20; trial++) {
        for (int i = 0; i < N; i++)
            x[i] = any_double(&seed);
        const double before = sum_of(x, N);
        shuffle(x, N, &seed);
        assert_same_bits(sum_of(x, N), before);
    }
}

/* Split over several sums and joined. */
static void test_split(void **state) {
    (void)state;
    uint64_t seed = 2;
    double x[N];
    for (int i = 0; i < N; i++)
        x[i] = any_double(&seed);
    const double all = sum_of(x, N);
    for (int parts = 1; parts < 9; parts++) {
        exact_sum *total = exact_new(2);
        for (int part = 0; part < parts; part++) {
            exact_sum *s = exact_new(2);
            for (int i = part; i < N; i += parts)
                exact_add(s, 1, x[i]);
            exact_join(total, s, 2);
            exact_free(s, 2);
        }
        assert_same_bits(exact_value(total, 1), all);
        assert_same_bits(exact_value(total, 0), 0.0);
        exact_free(total, 2);
    }
}

/* Everything cancels but one small number. */
static void test_cancellation(void **state) {
    (void)state;
    static const double left[] = {
        0.0, 5e-324, -5e-324, DBL_MIN, -1.0 / 3.0, 1e300, 2.2250738585072009e-308};
    uint64_t seed = 3;
    double x[2 * N + 1];
    for (size_t k = 0; k < sizeof left / sizeof left[0]; k++) {
        for (int i = 0; i < N; i++) {
            x[i] = any_double(&seed);
            x[N + i] = -x[i];
        }
        x[2 * N] = left[k];
        shuffle(x, 2 * N + 1, &seed);
        assert_same_bits(sum_of(x, 2 * N + 1), left[k]);
    }
}

/* Two doubles: IEEE addition rounds to nearest too, and TwoSum tells a tie (which goes away from
 * zero here, to even there). */
static void test_two_terms(void **state) {
    (void)state;
    uint64_t seed = 4;
    for (int i = 0; i < 3000; i++) {
        double x[2] = {any_double(&seed)};
        x[1] = x[0] * (uniform(&seed) - 0.5) * ldexp(1.0, (int)(120.0 * uniform(&seed)) - 60);
        const double sum = x[0] + x[1];
        if (!isfinite(sum) || !isfinite(x[1]))
            continue;
        const double b = sum - x[0];
        const double rest = (x[0] - (sum - b)) + (x[1] - b);
        const double up = nextafter(sum, copysign(INFINITY, sum));
        const bool tie = rest != 0.0 && fabs(rest) == 0.5 * fabs(up - sum);
        if (!tie)
            assert_same_bits(sum_of(x, 2), sum);
    }
}

static void test_rounding(void **state) {
    (void)state;
    const double ulp = DBL_EPSILON;
    assert_same_bits(sum_of((double[]){1.0, 0.5 * ulp}, 2), 1.0 + ulp); /* a tie: away from zero */
    assert_same_bits(sum_of((double[]){-1.0, -0.5 * ulp}, 2), -1.0 - ulp); /* on both sides */
    assert_same_bits(sum_of((double[]){1.0, 0.5 * ulp, -5e-324}, 3), 1.0);
    assert_same_bits(sum_of((double[]){1.0, 0.5 * ulp, 5e-324}, 3), 1.0 + ulp);
    assert_same_bits(sum_of((double[]){2.0 - ulp, 0.5 * ulp}, 2),
                     2.0); /* carries into the next power of two */
    assert_same_bits(sum_of((double[]){DBL_MIN, -5e-324}, 2), DBL_MIN - 5e-324);
    assert_same_bits(sum_of((double[]){DBL_MAX, DBL_MAX, -DBL_MAX}, 3), DBL_MAX);
    assert_same_bits(sum_of((double[]){-DBL_MAX, -DBL_MAX}, 2), -INFINITY);
    assert_same_bits(sum_of((double[]){-0.0, 0.0}, 2), 0.0);
}

/* n times x is n x rounded once, which IEEE multiplication does too. */
static void test_many(void **state) {
    (void)state;
    exact_sum *s = exact_new(1);
    for (int i = 1; i <= 20000; i++) {
        exact_add(s, 0, 0.1);
        if (i % 999 == 0)
            assert_same_bits(exact_value(s, 0), i * 0.1);
    }
    exact_free(s, 1);
}

static void test_text(void **state) {
    (void)state;
    uint64_t seed = 6;
    exact_sum *s = exact_new(2);
    for (int i = 0; i < 200; i++) {
        exact_add(s, 0, any_double(&seed));
        char *text = exact_format(s, 0);
        assert_non_null(text);
        assert_true(exact_parse(s, 1, text));
        assert_same_bits(exact_value(s, 1), exact_value(s, 0));
        char *again = exact_format(s, 1);
        assert_string_equal(again, text);
        free(text);
        free(again);
    }
    exact_free(s, 2);
}

static void test_bad_text(void **state) {
    (void)state;
    static const char *const bad[] = {"",    "-",  "--1", "+1",  " 1",  "1 ",
                                      "0x1", "1g", "A",   "1.5", "-1-", "1\n"};
    char endless[2000];
    exact_sum *s = exact_new(1);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_false(exact_parse(s, 0, bad[i]));
    memset(endless, 'f', sizeof endless - 1);
    endless[sizeof endless - 1] = '\0';
    assert_false(exact_parse(s, 0, endless));
    assert_true(exact_parse(s, 0, "-0"));
    assert_same_bits(exact_value(s, 0), 0.0);
    exact_free(s, 1);
    exact_free(NULL, 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_order),        cmocka_unit_test(test_split),
        cmocka_unit_test(test_cancellation), cmocka_unit_test(test_two_terms),
        cmocka_unit_test(test_rounding),     cmocka_unit_test(test_many),
        cmocka_unit_test(test_text),         cmocka_unit_test(test_bad_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
