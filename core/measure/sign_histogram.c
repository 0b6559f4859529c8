/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/sign_histogram.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Without branches, which nobody could predict here: the sides are random. */
static int side_of(double value) {
    return (value > 0.0) - (value < 0.0);
}

int fold_bin(const fold *f, double size) {
    int bin = 0;
    for (int part = f->bins; part > 1;) {
        const int half = part / 2;
        bin += half * (size >= f->edge[bin + half]);
        part -= half;
    }
    return bin;
}

void fold_count(const fold *f, double g, fold_counts *counts) {
    memset(counts->difference, 0, (size_t)f->bins * sizeof *counts->difference);
    memset(counts->square, 0, (size_t)f->bins * sizeof *counts->square);
    for (size_t i = 0; i < f->n; i++) {
        const int64_t w = f->weight[i];
        const double value = f->x[i] - g * f->b[i];
        const int bin = fold_bin(f, fabs(value));
        counts->difference[bin] += w * side_of(value);
        counts->square[bin] += w * w;
    }
}

static uint64_t bits_of(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* The mixing is that of splitmix64. */
uint8_t fold_group(double first, double second) {
    uint64_t z = bits_of(first) * UINT64_C(0x9E3779B97F4A7C15) + bits_of(second);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return (uint8_t)((z ^ (z >> 31)) % FOLD_GROUPS);
}

void fold_count_groups(const fold *f, double g, fold_counts *counts) {
    const size_t all = FOLD_GROUPS * (size_t)f->bins;
    memset(counts->difference, 0, all * sizeof *counts->difference);
    memset(counts->square, 0, all * sizeof *counts->square);
    for (size_t i = 0; i < f->n; i++) {
        const int64_t w = f->weight[i];
        const double value = f->x[i] - g * f->b[i];
        const size_t at = (size_t)(f->group[i] * f->bins + fold_bin(f, fabs(value)));
        counts->difference[at] += w * side_of(value);
        counts->square[at] += w * w;
    }
}

int64_t fold_balance(const fold *f, double g) {
    int64_t sum = 0;
    for (size_t i = 0; i < f->n; i++) {
        sum += (int64_t)f->weight[i] * side_of(f->x[i] - g * f->b[i]);
    }
    return sum;
}

static int compare_doubles(const void *a, const void *b) {
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

void fold_quantiles(const fold *f, double g, double *scratch, double *edge) {
    size_t n = 0;
    for (size_t i = 0; i < f->n; i++) {
        if (f->weight[i] > 0) {
            scratch[n++] = fabs(f->x[i] - g * f->b[i]);
        }
    }
    qsort(scratch, n, sizeof *scratch, compare_doubles);
    edge[0] = 0.0;
    for (int i = 1; i < f->bins; i++) {
        const double rest = 1.0 - (double)i / f->bins;
        edge[i] = scratch[(size_t)((1.0 - rest * rest) * (double)n)];
    }
}
