/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ticks at round numbers, and their labels. */
#include "shear_figures/scale.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const int DIGITS[3] = {1, 2, 5}; /* of a tick's distance, times a power of ten */

/* Rounding must not drop a tick at an end of the axis. */
static const double SLACK = 1e-9;
static const char MINUS[] = "\xe2\x88\x92"; /* U+2212, as wide as a digit */

typedef struct step {
    int digit;    /* 1, 2 or 5 */
    int exponent; /* times 10^exponent */
    double first; /* range of multiples: first .. last */
    double last;
} step;

/* 1/10^n is rounded once, and so prints better than 10^-n; beyond 10^300 it would be 1/infinity. */
static double power_of_ten(int exponent) {
    return exponent < 0 && exponent > -300 ? 1.0 / pow(10.0, -exponent) : pow(10.0, exponent);
}

static double step_size(const step *s) {
    return s->digit * power_of_ten(s->exponent);
}

/* Return the number of multiples of the step within [lo, hi]. */
static double count_multiples(step *s, double lo, double hi) {
    const double size = step_size(s);
    s->first = ceil(lo / size - SLACK);
    s->last = floor(hi / size + SLACK);
    return s->last - s->first + 1.0;
}

/* Return the smallest step of 1, 2, 5 times 10^k that gives at most at_most ticks. */
static step choose_step(double lo, double hi, int at_most) {
    const int start = (int)floor(log10((hi - lo) / at_most)) - 1; /* certainly too small */
    step s = {0};
    for (int i = 0; i < 12; i++) {
        s = (step){.digit = DIGITS[i % 3], .exponent = start + i / 3};
        if (count_multiples(&s, lo, hi) <= at_most)
            break;
    }
    return s;
}

/* Write `number` with `decimals` decimals, with a minus sign (U+2212). */
static void write_number(char label[SHEAR_TICK_LABEL], double number, int decimals) {
    char digits[SHEAR_TICK_LABEL];
    snprintf(digits, sizeof digits, "%.*f", decimals, fabs(number));
    const bool zero = strspn(digits, "0.") == strlen(digits);
    snprintf(label, SHEAR_TICK_LABEL, "%s%.*s", number < 0 && !zero ? MINUS : "",
             SHEAR_TICK_LABEL - (int)sizeof MINUS, digits);
}

static void write_power(char label[SHEAR_TICK_LABEL], int digit, int exponent) {
    char factor[8] = "";
    if (digit != 1) {
        snprintf(factor, sizeof factor, "%d\xc3\x97", digit % 10); /* 2 x */
    }
    snprintf(label, SHEAR_TICK_LABEL, "%s10^{%s%d}", factor, exponent < 0 ? MINUS : "",
             exponent < 0 ? -exponent : exponent);
}

void shear_ticks_linear(shear_ticks *t, double lo, double hi, int at_most) {
    *t = (shear_ticks){0};
    if (!isfinite(lo) || !isfinite(hi) || !(hi - lo > 0.0) || !isfinite(hi - lo))
        return;
    at_most = at_most < 2 ? 2 : at_most > SHEAR_MAX_TICKS ? SHEAR_MAX_TICKS : at_most;
    const step s = choose_step(lo, hi, at_most);
    const double largest = fmax(fabs(lo), fabs(hi));
    if (largest >= 1e5 || largest < 1e-2)
        t->exponent = (int)floor(log10(largest) + SLACK);
    const int decimals = s.exponent < t->exponent ? t->exponent - s.exponent : 0;
    const int n = (int)fmin(s.last - s.first + 1.0, at_most);
    for (t->n = 0; t->n < n; t->n++) {
        const double multiple = (s.first + t->n) * s.digit;
        t->at[t->n] = multiple * power_of_ten(s.exponent);
        /* The difference of the exponents is used because 10^exponent may be out of range. */
        write_number(t->label[t->n], multiple * power_of_ten(s.exponent - t->exponent),
                     decimals < 12 ? decimals : 12);
    }
}

/* Add ticks digit x 10^e for the given digits, e in steps of `stride`. Returns how many there are;
 * t contains the first at_most. */
static int log_candidates(shear_ticks *t, double lo, double hi, int at_most, int stride,
                          int n_digits) {
    const int first = (int)floor(log10(lo));
    const int last = (int)ceil(log10(hi));
    int n = 0;
    *t = (shear_ticks){0};
    for (int e = first; e <= last; e++) {
        for (int d = 0; d < n_digits && e % stride == 0; d++) {
            const double at = DIGITS[d] * power_of_ten(e);
            if (at < lo * (1.0 - SLACK) || at > hi * (1.0 + SLACK))
                continue;
            if (n < at_most) {
                t->at[n] = at;
                if (n_digits > 1 && e >= -3 && e <= 4) {
                    write_number(t->label[n], at, e < 0 ? -e : 0);
                } else {
                    write_power(t->label[n], DIGITS[d], e);
                }
                t->n = n + 1;
            }
            n++;
        }
    }
    return n;
}

void shear_ticks_log(shear_ticks *t, double lo, double hi, int at_most) {
    *t = (shear_ticks){0};
    if (!(lo >= DBL_MIN) || !(hi > lo) || !isfinite(hi))
        return;
    at_most = at_most < 2 ? 2 : at_most > SHEAR_MAX_TICKS ? SHEAR_MAX_TICKS : at_most;
    int n = log_candidates(t, lo, hi, at_most, 1, 1);
    const bool decades = n >= 2;
    for (int stride = 2; n > at_most; stride++)
        n = log_candidates(t, lo, hi, at_most, stride, 1);
    if (decades)
        return;
    n = log_candidates(t, lo, hi, at_most, 1, 3);
    if (n < 2 || n > at_most)
        shear_ticks_linear(t, lo, hi, at_most);
}

/* Insert a tick in order, unless another one is too close. */
static void insert_apart(shear_ticks *t, const shear_stretch *s, double at, double apart) {
    const double place = shear_stretch_apply(s, at);
    int before = 0;
    for (int i = 0; i < t->n; i++) {
        if (fabs(shear_stretch_apply(s, t->at[i]) - place) < apart)
            return;
        before += t->at[i] < at;
    }
    if (t->n == SHEAR_MAX_TICKS || at < s->span.lo || at > s->span.hi)
        return;
    memmove(&t->at[before + 1], &t->at[before], (size_t)(t->n - before) * sizeof t->at[0]);
    t->at[before] = at;
    t->n++;
}

/* Add 0 and the powers of ten from the largest down, then 5 and 2 times them if there is space. */
static void asinh_places(shear_ticks *t, const shear_stretch *s, double apart) {
    static const int digits[3] = {1, 5, 2};
    const double largest = fmax(fabs(s->span.lo), fabs(s->span.hi));
    const int top = (int)floor(log10(largest) + SLACK);
    insert_apart(t, s, 0.0, apart);
    for (int d = 0; d < 3; d++) {
        for (int e = top; e > top - 8; e--) {
            insert_apart(t, s, digits[d] * power_of_ten(e), apart);
            insert_apart(t, s, -digits[d] * power_of_ten(e), apart);
        }
    }
}

/* Label asinh ticks, which span decades: small numbers with %g, others as powers. */
static void write_asinh_label(char label[SHEAR_TICK_LABEL], double at) {
    const double magnitude = fabs(at);
    if (magnitude > 0.0 && (magnitude < 1e-2 || magnitude >= 1e5)) {
        const int exponent = (int)floor(log10(magnitude) + SLACK);
        char power[SHEAR_TICK_LABEL];
        write_power(power, (int)lround(magnitude / power_of_ten(exponent)), exponent);
        snprintf(label, SHEAR_TICK_LABEL, "%s%.*s", at < 0.0 ? MINUS : "",
                 SHEAR_TICK_LABEL - (int)sizeof MINUS, power);
        return;
    }
    const int decimals = magnitude >= 1.0 || magnitude == 0.0 ? 0 : magnitude >= 0.1 ? 1 : 2;
    write_number(label, at, decimals);
}

void shear_ticks_stretch(shear_ticks *t, const shear_stretch *s, int at_most) {
    at_most = at_most < 2 ? 2 : at_most > SHEAR_MAX_TICKS ? SHEAR_MAX_TICKS : at_most;
    if (s->kind == SHEAR_LOG) {
        shear_ticks_log(t, s->span.lo, s->span.hi, at_most);
        return;
    }
    if (s->kind != SHEAR_ASINH) {
        shear_ticks_linear(t, s->span.lo, s->span.hi, at_most);
        return;
    }
    *t = (shear_ticks){0};
    asinh_places(t, s, 1.0 / at_most);
    for (int i = 0; i < t->n; i++)
        write_asinh_label(t->label[i], t->at[i]);
}
