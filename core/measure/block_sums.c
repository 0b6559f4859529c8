/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/block_sums.h"

#include <math.h>

void shear_block_sums_init(shear_block_sums *b) {
    *b = (shear_block_sums){0};
}

/* Neumaier's compensated summation: lo accumulates what each addition rounds off. */
static void add_term(shear_block_sums *b, int term, double x) {
    const double sum = b->hi[term] + x;
    b->lo[term] += fabs(b->hi[term]) >= fabs(x) ? (b->hi[term] - sum) + x : (x - sum) + b->hi[term];
    b->hi[term] = sum;
}

/* Limit of a term: sums over 1e10 stamps of N and D up to its square root, and products of such
 * sums, stay finite. */
static const double largest_term = 1e280;

/* Fill x with w times the components of a row. */
static void weigh_components(const shear_row *row, double *x) {
    const double parts[SHEAR_N_COMPONENTS] = {
        [SHEAR_C_N1] = row->n1,
        [SHEAR_C_N2] = row->n2,
        [SHEAR_C_D] = row->d,
        [SHEAR_C_NOISE_N1] = row->noise_n1,
        [SHEAR_C_NOISE_N2] = row->noise_n2,
        [SHEAR_C_NOISE_D] = row->noise_d,
        [SHEAR_C_HIGH_GALAXY] = row->high_galaxy,
        [SHEAR_C_HIGH_NOISE] = row->high_noise,
    };
    for (int i = 0; i < SHEAR_N_COMPONENTS; i++)
        x[i] = row->weight * parts[i];
}

/* A stamp is bright if noise changes D by less than this part of M20 + M02, and sharper than its
 * PSF if D is below minus this part of it, by SHARP_SIGMA errors: a PSF that is 4 % too broad makes
 * a point source so (docs/method.md, section 5.1). */
static const double SHARP_PART = 0.02, SHARP_SIGMA = 3.0;

bool shear_row_is_bright(const shear_row *row) {
    const double least = SHARP_PART * (row->m20 + row->m02);
    return row->flags == 0 && row->d_err < least && fabs(row->noise_d) < least && row->weight > 0.0;
}

bool shear_row_is_sharp(const shear_row *row) {
    return shear_row_is_bright(row) &&
           row->d < -SHARP_PART * (row->m20 + row->m02) - SHARP_SIGMA * row->d_err;
}

/* Fill in a term and the next one, its square. */
static void put_with_square(double *terms, enum shear_term term, double x) {
    terms[term] = x;
    terms[term + 1] = x * x;
}

bool block_terms(const shear_row *row, double *terms) {
    double *x = terms + SHEAR_S_COMPONENT;
    weigh_components(row, x);
    for (int j = 0, at = SHEAR_S_PRODUCT; j < SHEAR_N_COMPONENTS; j++) {
        for (int i = 0; i <= j; i++, at++)
            terms[at] = x[i] * x[j];
    }
    terms[SHEAR_S_W] = row->weight;
    terms[SHEAR_S_POWER] = row->weight * (row->m20 + row->m02);
    terms[SHEAR_S_NOISE_U] = row->weight * row->noise_u;
    terms[SHEAR_S_NOISE_V] = row->weight * row->noise_v;
    terms[SHEAR_S_CORNER_GALAXY] = row->weight * row->corner_galaxy;
    terms[SHEAR_S_CORNER_NOISE] = row->weight * row->corner_noise;
    terms[SHEAR_S_FLUX] = row->flux;
    terms[SHEAR_S_BORDER_NOISE] = row->border_var_noise;
    put_with_square(terms, SHEAR_S_REMOVED, row->flux_removed);
    put_with_square(terms, SHEAR_S_BORDER_MEAN, row->border_mean);
    put_with_square(terms, SHEAR_S_BORDER_VAR, row->border_var);
    put_with_square(terms, SHEAR_S_BORDER_STEP_X, row->border_step_x);
    put_with_square(terms, SHEAR_S_BORDER_STEP_Y, row->border_step_y);
    put_with_square(terms, SHEAR_S_BORDER_STEP2, row->border_step2);
    terms[SHEAR_S_BRIGHT] = shear_row_is_bright(row) ? 1.0 : 0.0;
    terms[SHEAR_S_SHARP] = shear_row_is_sharp(row) ? 1.0 : 0.0;
    terms[SHEAR_S_BRIGHT_TRIPLES] = terms[SHEAR_S_SHARP_TRIPLES] = 0.0;
    bool good = true;
    for (int term = 0; term < SHEAR_N_TERMS; term++)
        good = good && fabs(terms[term]) < largest_term;
    return good;
}

static void add_influence(shear_block_sums *b, const double *x, int64_t stamp) {
    const double size = fmax(fmax(fabs(x[SHEAR_C_N1]), fabs(x[SHEAR_C_N2])), fabs(x[SHEAR_C_D]));
    if (size > b->top.size)
        b->top = (shear_influence){.size = size, .stamp = stamp};
}

static double pairs(double n) {
    return 0.5 * n * (n - 1.0);
}

void shear_block_sums_add(shear_block_sums *b, const shear_row *row) {
    double terms[SHEAR_N_TERMS];
    const bool summable = block_terms(row, terms);
    const uint32_t flags =
        row->flags == 0 && !summable ? (uint32_t)SHEAR_FLAG_OVERFLOW : row->flags;
    b->n_stamps++;
    b->framed[row->frame]++;
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++)
        b->flagged[bit] += (flags >> bit) & 1u;
    if (flags != 0)
        return;
    b->n_used++;
    add_influence(b, terms + SHEAR_S_COMPONENT, row->stamp);
    terms[SHEAR_S_BRIGHT_TRIPLES] = terms[SHEAR_S_BRIGHT] * pairs(b->hi[SHEAR_S_BRIGHT]);
    terms[SHEAR_S_SHARP_TRIPLES] = terms[SHEAR_S_SHARP] * pairs(b->hi[SHEAR_S_SHARP]);
    for (int term = 0; term < SHEAR_N_TERMS; term++)
        add_term(b, term, terms[term]);
}
