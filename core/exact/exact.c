/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "exact/exact.h"

#include <assert.h>
#include <gmp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MANTISSA_BITS = 53, LOWEST_EXPONENT = -1074 };

struct exact_sum {
    mpz_t units; /* the sum in units of 2^-1074 */
};

exact_sum *exact_new(int n) {
    exact_sum *sums = malloc((size_t)n * sizeof *sums);
    for (int i = 0; sums != NULL && i < n; i++)
        mpz_init(sums[i].units);
    return sums;
}

void exact_free(exact_sum *sums, int n) {
    for (int i = 0; sums != NULL && i < n; i++)
        mpz_clear(sums[i].units);
    free(sums);
}

void exact_add(exact_sum *sums, int i, double value) {
    assert(isfinite(value));
    if (value == 0.0)
        return;
    int exponent = 0;
    const double fraction = frexp(value, &exponent);
    double integer = ldexp(fraction, MANTISSA_BITS);
    int shift = exponent - MANTISSA_BITS - LOWEST_EXPONENT;
    if (shift < 0) { /* a subnormal: its low bits are zeros */
        integer = ldexp(integer, shift);
        shift = 0;
    }
    mpz_t term;
    mpz_init_set_d(term, integer);
    mpz_mul_2exp(term, term, (mp_bitcnt_t)shift);
    mpz_add(sums[i].units, sums[i].units, term);
    mpz_clear(term);
}

void exact_join(exact_sum *sums, const exact_sum *other, int n) {
    for (int i = 0; i < n; i++)
        mpz_add(sums[i].units, sums[i].units, other[i].units);
}

void exact_leave(exact_sum *sums, const exact_sum *other, int n) {
    for (int i = 0; i < n; i++)
        mpz_sub(sums[i].units, sums[i].units, other[i].units);
}

double exact_value(const exact_sum *sums, int i) {
    const size_t bits = mpz_sizeinbase(sums[i].units, 2);
    if (mpz_sgn(sums[i].units) == 0)
        return 0.0;
    /* Round the magnitude to 53 bits: truncate to one more, add that last one, and halve. */
    const mp_bitcnt_t drop = bits > MANTISSA_BITS ? bits - MANTISSA_BITS : 0;
    mpz_t top;
    mpz_init(top);
    mpz_abs(top, sums[i].units);
    if (drop > 0) {
        mpz_fdiv_q_2exp(top, top, drop - 1);
        mpz_add_ui(top, top, 1);
        mpz_fdiv_q_2exp(top, top, 1);
    }
    const double magnitude = ldexp(mpz_get_d(top), (int)drop + LOWEST_EXPONENT);
    mpz_clear(top);
    return mpz_sgn(sums[i].units) < 0 ? -magnitude : magnitude;
}

char *exact_format(const exact_sum *sums, int i) {
    char *text = malloc(mpz_sizeinbase(sums[i].units, 16) + 2);
    if (text != NULL)
        mpz_get_str(text, 16, sums[i].units);
    return text;
}

bool exact_parse(exact_sum *sums, int i, const char *text) {
    /* The largest sum possible is 2^63 terms of 2^1024. Longer text is not one of these sums. */
    enum { MAX_DIGITS = (1024 + 1074 + 64) / 4 + 2 };
    const size_t length = strnlen(text, MAX_DIGITS + 1);
    const size_t sign = text[0] == '-' ? 1 : 0;
    if (length <= sign || length > MAX_DIGITS ||
        strspn(text + sign, "0123456789abcdef") != length - sign) {
        return false;
    }
    return mpz_set_str(sums[i].units, text, 16) == 0;
}
