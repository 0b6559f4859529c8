/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Transforms of eight lanes: against the sum that defines them, laws, and the contract for
 * buffers. */
#include "fft/fft.h"

#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_N = 1024 };

static const double eps = 2.2e-16;

static fft_lanes new_lanes(int n) {
    arena a = {0};
    fft_lanes_take(&a, n);
    assert_non_null(arena_allocate(&a));
    return fft_lanes_take(&a, n);
}

static void draw(fft_lanes x, int n, uint64_t seed) {
    for (int i = 0; i < n * FFT_LANES; i++) {
        x.re[i] = uniform(&seed) - 0.5;
        x.im[i] = uniform(&seed) - 0.5;
    }
}

static void copy(fft_lanes to, fft_lanes from, int n) {
    memcpy(to.re, from.re, (size_t)n * FFT_LANES * sizeof(double));
    memcpy(to.im, from.im, (size_t)n * FFT_LANES * sizeof(double));
}

/* Mode k of one lane, by its sum. */
static void mode(fft_lanes x, int n, int lane, int k, double *re, double *im) {
    *re = *im = 0.0;
    for (int j = 0; j < n; j++) {
        const double angle = -2.0 * M_PI * (double)((int64_t)j * k % n) / n;
        const double a = x.re[j * FFT_LANES + lane];
        const double b = x.im[j * FFT_LANES + lane];
        *re += a * cos(angle) - b * sin(angle);
        *im += a * sin(angle) + b * cos(angle);
    }
}

static void check_modes(fft_lanes x, fft_lanes z, int n, int every) {
    for (int lane = 0; lane < FFT_LANES; lane++) {
        for (int k = 0; k < n; k += every) {
            double re;
            double im;
            mode(x, n, lane, k, &re, &im);
            /* n numbers of order 1: both sums round at sqrt(n) eps or so. */
            assert_near(z.re[k * FFT_LANES + lane], re, 4.0 * n * eps, 1.0, "re");
            assert_near(z.im[k * FFT_LANES + lane], im, 4.0 * n * eps, 1.0, "im");
        }
    }
}

/* One length: between separate buffers, over its own input, and from rows that lie apart. */
static void check_length(int n, int every) {
    enum { STEP = FFT_LANES + 3 };
    static double re[MAX_N * STEP];
    static double im[MAX_N * STEP];
    fft_plan *plan = fft_plan_new(n);
    fft_lanes x = new_lanes(n);
    fft_lanes in = new_lanes(n);
    fft_lanes a = new_lanes(n);
    fft_lanes b = new_lanes(n);
    assert_non_null(plan);
    draw(x, n, (uint64_t)n);
    copy(in, x, n);
    const fft_lanes z = fft_run(plan, in.re, in.im, FFT_LANES, a, b);
    assert_true(z.re == a.re || z.re == b.re);
    check_modes(x, z, n, every);
    assert_memory_equal(in.re, x.re, (size_t)n * FFT_LANES * sizeof(double)); /* kept */
    assert_memory_equal(in.im, x.im, (size_t)n * FFT_LANES * sizeof(double));
    fft_lanes c = new_lanes(n);
    const fft_lanes over = fft_run(plan, in.re, in.im, FFT_LANES, c, in);
    assert_memory_equal(over.re, z.re, (size_t)n * FFT_LANES * sizeof(double));
    assert_memory_equal(over.im, z.im, (size_t)n * FFT_LANES * sizeof(double));
    for (int i = 0; i < n * FFT_LANES; i++) {
        re[i / FFT_LANES * STEP + i % FFT_LANES] = x.re[i];
        im[i / FFT_LANES * STEP + i % FFT_LANES] = x.im[i];
    }
    fft_lanes d = new_lanes(n);
    const fft_lanes apart = fft_run(plan, re, im, STEP, c, d);
    assert_memory_equal(apart.re, z.re, (size_t)n * FFT_LANES * sizeof(double));
    assert_memory_equal(apart.im, z.im, (size_t)n * FFT_LANES * sizeof(double));
    free(x.re);
    free(in.re);
    free(a.re);
    free(b.re);
    free(c.re);
    free(d.re);
    fft_plan_free(plan);
}

/* All short lengths: every radix first and last, and primes, which FFTW does. */
static void test_short_lengths(void **state) {
    (void)state;
    for (int n = 2; n <= 130; n++)
        check_length(n, 1);
}

static void test_long_lengths(void **state) {
    (void)state;
    static const int lengths[] = {144, 160, 192, 200, 225, 240, 243,  256,
                                  259, 320, 375, 512, 625, 768, 1000, 1024};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++)
        check_length(lengths[i], 37);
}

/* Lanes do not see each other: seven of NaN leave the eighth as it is. */
static void test_lanes_are_apart(void **state) {
    (void)state;
    static const int lengths[] = {8, 30, 31, 64};
    for (int i = 0; i < 4; i++) {
        const int n = lengths[i];
        fft_plan *plan = fft_plan_new(n);
        fft_lanes x = new_lanes(n);
        fft_lanes a = new_lanes(n);
        fft_lanes b = new_lanes(n);
        fft_lanes c = new_lanes(n);
        fft_lanes d = new_lanes(n);
        draw(x, n, 5);
        const fft_lanes z = fft_run(plan, x.re, x.im, FFT_LANES, a, b);
        for (int k = 0; k < n * FFT_LANES; k++)
            x.re[k] = k % FFT_LANES == 3 ? x.re[k] : NAN;
        const fft_lanes alone = fft_run(plan, x.re, x.im, FFT_LANES, c, d);
        for (int k = 3; k < n * FFT_LANES; k += FFT_LANES)
            assert_true(alone.re[k] == z.re[k] && alone.im[k] == z.im[k]);
        free(x.re);
        free(a.re);
        free(b.re);
        free(c.re);
        free(d.re);
        fft_plan_free(plan);
    }
}

static void test_turn(void **state) {
    (void)state;
    enum { STEP = 11 };
    double in[FFT_LANES * STEP];
    double out[FFT_LANES * FFT_LANES];
    uint64_t seed = 3;
    for (int i = 0; i < FFT_LANES * STEP; i++)
        in[i] = uniform(&seed);
    fft_transpose(in, STEP, out);
    for (int i = 0; i < FFT_LANES * FFT_LANES; i++)
        assert_true(out[i] == in[i % FFT_LANES * STEP + i / FFT_LANES]);
    fft_transpose(in + (FFT_LANES - 1) * STEP, -STEP, out); /* backwards */
    for (int i = 0; i < FFT_LANES * FFT_LANES; i++)
        assert_true(out[i] == in[(FFT_LANES - 1 - i % FFT_LANES) * STEP + i / FFT_LANES]);
}

static void test_sizes(void **state) {
    (void)state;
    for (int n = 1; n < 300; n++) {
        assert_true(fft_padded(n) >= (size_t)n && fft_padded(n) < (size_t)n + FFT_LANES &&
                    fft_padded(n) % FFT_LANES == 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_short_lengths),
                                       cmocka_unit_test(test_long_lengths),
                                       cmocka_unit_test(test_lanes_are_apart),
                                       cmocka_unit_test(test_turn), cmocka_unit_test(test_sizes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
