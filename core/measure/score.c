/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/score.h"

#include <assert.h>
#include <stdbool.h>
#include <string.h>

/* Up to `few` stamps the curve has two terms, up to `many` three; beyond, each bin has its own
 * score. */
static const double few = 1000.0;
static const double many = 4000.0;

int scores_terms(double stamps) {
    return stamps < few ? 2 : stamps < many ? 3 : 0;
}

void scores_place(scores *s, int bins, arena *a) {
    assert(bins >= 1);
    const size_t nb = (size_t)bins;
    *s = (scores){.bins = bins,
                  .all = arena_doubles(a, nb),
                  .without = arena_doubles(a, SIGN_GROUPS * nb),
                  .fall = arena_doubles(a, (SIGN_GROUPS + 1) * nb),
                  .size = arena_doubles(a, (SIGN_GROUPS + 1) * nb)};
    for (int k = 0; k < 2; k++)
        sign_counts_place(&s->at[k], bins, a);
}

/* Fill in the powers t .. t^n of a bin's place. */
static void powers(int i, int bins, int n, double *power) {
    const double t = (i + 0.5) / bins;
    power[0] = t;
    for (int k = 1; k < n; k++)
        power[k] = power[k - 1] * t;
}

/* Solve the n normal equations m c = r, m symmetric. A coefficient that the data do not determine
 * is 0. */
static void solve_normal(double m[SCORE_TERMS][SCORE_TERMS], double *r, int n, double *c) {
    static const double singular = 1e-9;
    double diagonal[SCORE_TERMS];
    for (int k = 0; k < n; k++)
        diagonal[k] = m[k][k];
    for (int k = 0; k < n; k++) {
        const bool told = m[k][k] > singular * diagonal[k];
        for (int i = k + 1; i < n && told; i++) {
            const double factor = m[i][k] / m[k][k];
            for (int j = k; j < n; j++)
                m[i][j] -= factor * m[k][j];
            r[i] -= factor * r[k];
        }
        m[k][k] = told ? m[k][k] : 0.0;
    }
    for (int k = n - 1; k >= 0; k--) {
        double rest = r[k];
        for (int j = k + 1; j < n; j++)
            rest -= m[k][j] * c[j];
        c[k] = m[k][k] > 0.0 ? rest / m[k][k] : 0.0;
    }
}

void score_curve(const double *fall, const double *size, int bins, int terms, double *score) {
    assert(terms >= 1 && terms <= SCORE_TERMS);
    double m[SCORE_TERMS][SCORE_TERMS] = {{0.0}};
    double r[SCORE_TERMS] = {0.0};
    double c[SCORE_TERMS] = {0.0};
    double t[SCORE_TERMS];
    for (int i = 0; i < bins; i++) {
        powers(i, bins, terms, t);
        for (int k = 0; k < terms; k++) {
            r[k] += fall[i] * t[k];
            for (int j = 0; j < terms; j++)
                m[k][j] += size[i] * t[k] * t[j];
        }
    }
    solve_normal(m, r, terms, c);
    for (int i = 0; i < bins; i++) {
        powers(i, bins, terms, t);
        score[i] = 0.0;
        for (int k = 0; k < terms; k++)
            score[i] += c[k] * t[k];
    }
}

static void set_scores(const scores *s, const double *fall, const double *size, double *score) {
    if (s->terms > 0) {
        score_curve(fall, size, s->bins, s->terms, score);
        return;
    }
    for (int i = 0; i < s->bins; i++)
        score[i] = size[i] > 0.0 ? fall[i] / size[i] : 0.0;
}

/* Compute each group's falls and sizes and, after them, those of all stamps. */
static void set_responses(scores *s, const sign_histogram *h, double g, double width) {
    const size_t nb = (size_t)s->bins;
    const size_t all = SIGN_GROUPS * nb;
    sign_histogram_count(h, g - width, &s->at[0]);
    sign_histogram_count(h, g + width, &s->at[1]);
    memset(s->fall + all, 0, nb * sizeof *s->fall);
    memset(s->size + all, 0, nb * sizeof *s->size);
    for (size_t i = 0; i < all; i++) {
        const double fall = (double)(s->at[0].difference[i] - s->at[1].difference[i]);
        s->fall[i] = fall / (2.0 * width);
        s->size[i] = 0.5 * (double)(s->at[0].square[i] + s->at[1].square[i]);
        s->fall[all + i % nb] += s->fall[i];
        s->size[all + i % nb] += s->size[i];
    }
}

void scores_fit(scores *s, const sign_histogram *h, double g, double width) {
    const size_t nb = (size_t)s->bins;
    const size_t all = SIGN_GROUPS * nb;
    set_responses(s, h, g, width);
    for (size_t i = 0; i < all; i++) { /* all stamps but the group's */
        s->fall[i] = s->fall[all + i % nb] - s->fall[i];
        s->size[i] = s->size[all + i % nb] - s->size[i];
    }
    for (size_t k = 0; k < SIGN_GROUPS; k++)
        set_scores(s, s->fall + k * nb, s->size + k * nb, s->without + k * nb);
    set_scores(s, s->fall + all, s->size + all, s->all);
}

double scores_slope(scores *s, const sign_histogram *h, double g, double half) {
    const size_t all = SIGN_GROUPS * (size_t)s->bins;
    double sum = 0.0;
    sign_histogram_count(h, g - half, &s->at[0]);
    sign_histogram_count(h, g + half, &s->at[1]);
    for (size_t i = 0; i < all; i++)
        sum += s->without[i] * (double)(s->at[0].difference[i] - s->at[1].difference[i]);
    return sum / (2.0 * half);
}
