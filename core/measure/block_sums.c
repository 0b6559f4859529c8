/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/block_sums.h"

#include <math.h>

void shear_block_sums_init(shear_block_sums *b) {
    *b = (shear_block_sums){0};
}

/* Neumaier's compensated summation: what each addition rounds off is gathered in lo. */
static void add_term(shear_block_sums *b, int term, double x) {
    const double sum = b->hi[term] + x;
    b->lo[term] += fabs(b->hi[term]) >= fabs(x) ? (b->hi[term] - sum) + x : (x - sum) + b->hi[term];
    b->hi[term] = sum;
}

/* N and D up to its root, summed over 1e10 stamps and multiplied with each other, stay finite. */
static const double largest_term = 1e280;

bool block_terms(const shear_row *row, double *terms) {
    const double n1 = row->weight * row->n1;
    const double n2 = row->weight * row->n2;
    const double d = row->weight * row->d;
    const double values[SHEAR_N_TERMS] = {
        [SHEAR_S_W] = row->weight,
        [SHEAR_S_N1] = n1,
        [SHEAR_S_N2] = n2,
        [SHEAR_S_D] = d,
        [SHEAR_S_N1N1] = n1 * n1,
        [SHEAR_S_N2N2] = n2 * n2,
        [SHEAR_S_N1N2] = n1 * n2,
        [SHEAR_S_N1D] = n1 * d,
        [SHEAR_S_N2D] = n2 * d,
        [SHEAR_S_DD] = d * d,
        [SHEAR_S_FLUX] = row->flux,
        [SHEAR_S_REMOVED] = row->flux_removed,
        [SHEAR_S_REMOVED2] = row->flux_removed * row->flux_removed,
        [SHEAR_S_BORDER_MEAN] = row->border_mean,
        [SHEAR_S_BORDER_MEAN2] = row->border_mean * row->border_mean,
        [SHEAR_S_BORDER_VAR] = row->border_var,
        [SHEAR_S_BORDER_VAR2] = row->border_var * row->border_var,
        [SHEAR_S_BORDER_NOISE] = row->border_var_noise,
    };
    bool good = true;
    for (int term = 0; term < SHEAR_N_TERMS; term++) {
        terms[term] = values[term];
        good = good && fabs(values[term]) < largest_term;
    }
    return good;
}

void shear_block_sums_add(shear_block_sums *b, const shear_row *row) {
    double terms[SHEAR_N_TERMS];
    const bool summable = block_terms(row, terms);
    const uint32_t flags =
        row->flags == 0 && !summable ? (uint32_t)SHEAR_FLAG_OVERFLOW : row->flags;
    b->n_stamps++;
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++) {
        b->flagged[bit] += (flags >> bit) & 1u;
    }
    if (flags != 0) {
        return;
    }
    b->n_used++;
    for (int term = 0; term < SHEAR_N_TERMS; term++) {
        add_term(b, term, terms[term]);
    }
}
