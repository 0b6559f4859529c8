/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/sign_histogram.h"

#include "base/sort.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* Return the sign of a value, without a branch: the signs are random, so it would be
 * mispredicted. */
static int side_of(double value) {
    return (value > 0.0) - (value < 0.0);
}

int sign_histogram_bin(const sign_histogram *h, double size) {
    int bin = 0;
    for (int part = h->bins; part > 1;) {
        const int half = part / 2;
        bin += half * (size >= h->edge[bin + half]);
        part -= half;
    }
    return bin;
}

void sign_counts_place(sign_counts *counts, int bins, arena *a) {
    const size_t all = SIGN_GROUPS * (size_t)bins;
    counts->difference = arena_take(a, all * sizeof *counts->difference);
    counts->square = arena_take(a, all * sizeof *counts->square);
}

static uint64_t bits_of(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Mixes as splitmix64 does. */
uint8_t sign_histogram_group(double first, double second) {
    uint64_t z = bits_of(first) * UINT64_C(0x9E3779B97F4A7C15) + bits_of(second);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return (uint8_t)((z ^ (z >> 31)) % SIGN_GROUPS);
}

void sign_histogram_count(const sign_histogram *h, double g, sign_counts *counts) {
    const size_t all = SIGN_GROUPS * (size_t)h->bins;
    memset(counts->difference, 0, all * sizeof *counts->difference);
    memset(counts->square, 0, all * sizeof *counts->square);
    for (size_t i = 0; i < h->n; i++) {
        const int64_t w = h->weight[i];
        const double value = h->x[i] - g * h->b[i];
        const size_t at =
            (size_t)h->group[i] * (size_t)h->bins + (size_t)sign_histogram_bin(h, fabs(value));
        counts->difference[at] += w * side_of(value);
        counts->square[at] += w * w;
    }
}

int64_t sign_histogram_balance(const sign_histogram *h, double g) {
    int64_t sum = 0;
    for (size_t i = 0; i < h->n; i++)
        sum += (int64_t)h->weight[i] * side_of(h->x[i] - g * h->b[i]);
    return sum;
}

void sign_histogram_quantiles(const sign_histogram *h, double g, double *scratch, double *edge) {
    size_t n = 0;
    for (size_t i = 0; i < h->n; i++) {
        if (h->weight[i] > 0)
            scratch[n++] = fabs(h->x[i] - g * h->b[i]);
    }
    assert(n > 0);
    sort_doubles(scratch, n);
    edge[0] = 0.0;
    for (int i = 1; i < h->bins; i++) {
        const double rest = 1.0 - (double)i / h->bins;
        edge[i] = scratch[(size_t)((1.0 - rest * rest) * (double)n)];
    }
}
