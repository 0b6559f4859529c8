/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Philox as a GSL generator. */
#include "random.h"
#include "test_mock_fixture.h"

#include <math.h>
#include <stdlib.h>

/* Random123's published answer for a zero key and counter: that no layer of ours reorders anything.
 */
static void test_known_answer(void **state) {
    (void)state;
    static const uint64_t answer[4] = {0x16554d9eca36314c, 0xdb20fe9d672d0fdc, 0xd7e772cee186176b,
                                       0x7e68b68aec7ba23b};
    random_sequence r;
    random_begin(&r, 0, 0, 0, 0);
    for (int i = 0; i < 4; i++)
        assert_int_equal(gsl_rng_get(&r.rng), answer[i] >> 32);
    random_begin(&r, 0, 0, 0, 0);
    for (int i = 0; i < 4; i++)
        assert_true(gsl_rng_uniform(&r.rng) == ldexp((double)(answer[i] >> 11), -53));
}

static void first_numbers(double out[6], uint64_t seed, int stream, uint64_t index, uint64_t item) {
    random_sequence r;
    random_begin(&r, seed, stream, index, item);
    for (int i = 0; i < 6; i++)
        out[i] = gsl_rng_uniform(&r.rng);
}

static void test_every_name_is_another_sequence(void **state) {
    (void)state;
    double base[6];
    double other[6];
    first_numbers(base, 7, RANDOM_GALAXY, 3, 5);
    first_numbers(other, 7, RANDOM_GALAXY, 3, 5);
    assert_memory_equal(base, other, sizeof base);
    const uint64_t names[][4] = {{8, RANDOM_GALAXY, 3, 5},
                                 {7, RANDOM_SHIFT, 3, 5},
                                 {7, RANDOM_GALAXY, 4, 5},
                                 {7, RANDOM_GALAXY, 3, 6}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        first_numbers(other, names[i][0], (int)names[i][1], names[i][2], names[i][3]);
        for (int k = 0; k < 6; k++) {
            for (int l = 0; l < 6; l++)
                assert_true(base[k] != other[l]);
        }
    }
}

static void test_item_restarts(void **state) {
    (void)state;
    double expected[6];
    random_sequence r;
    first_numbers(expected, 7, RANDOM_PHOTONS, 3, 2);
    random_begin(&r, 7, RANDOM_PHOTONS, 3, 0);
    for (int i = 0; i < 7; i++)
        gsl_rng_uniform(&r.rng);
    random_item(&r, 2);
    for (int i = 0; i < 6; i++)
        assert_true(gsl_rng_uniform(&r.rng) == expected[i]);
}

static double uniform_cdf(double x, void *context) {
    (void)context;
    return x;
}

/* First numbers of neighbouring items and indices, the way mocks use them. */
static void test_uniform_across_sequences(void **state) {
    (void)state;
    enum { N = 20000 };
    double *v = doubles(N);
    random_sequence r;
    for (int i = 0; i < N; i++) {
        random_begin(&r, 1, RANDOM_GALAXY, (uint64_t)(i / 100), (uint64_t)(i % 100));
        v[i] = gsl_rng_uniform(&r.rng);
        assert_true(v[i] >= 0.0 && v[i] < 1.0);
    }
    assert_true(ks_of(v, N, uniform_cdf, NULL) < 1.95); /* one in a thousand */
    free(v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known_answer),
        cmocka_unit_test(test_every_name_is_another_sequence),
        cmocka_unit_test(test_item_restarts),
        cmocka_unit_test(test_uniform_across_sequences),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
