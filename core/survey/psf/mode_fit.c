/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/mode_fit.h"

#include "base/cleanup.h"
#include "survey/psf/least_squares.h"

#include <stdlib.h>

enum { MOST_NUMBERS = 1 << 26, MOST_TERMS = 10 /* degree 3 */ };

static size_t modes(int stamp) {
    return (size_t)stamp * (size_t)stamp;
}

int mode_spectra_init(mode_spectra *s, int n, int stamp, sf_place at, shear_error *err) {
    *s = (mode_spectra){.n = n, .stamp = stamp};
    if ((size_t)n * modes(stamp) > MOST_NUMBERS) {
        return sf_fail(err, SHEAR_E_FORMAT, at, "use fewer images",
                       "%d images at %d x %d modes are too many: 2^26 numbers are the most", n,
                       stamp, stamp);
    }
    s->power = calloc((size_t)n * modes(stamp), sizeof *s->power);
    s->weight = calloc((size_t)n, sizeof *s->weight);
    return s->power != NULL && s->weight != NULL ? SHEAR_OK : sf_fail_memory(err, at);
}

void mode_spectra_deinit(mode_spectra *s) {
    free(s->power);
    free(s->weight);
    *s = (mode_spectra){0};
}

double *mode_spectra_of(const mode_spectra *s, int i) {
    return s->power + (size_t)i * modes(s->stamp);
}

/* Compute the matrix m[terms][n] of the fit with polynomial p. Return false if it is not
 * determined. */
static bool fit_matrix(const polynomial *p, const psf_places *places, const double *weight,
                       double *basis, double *m) {
    const int terms = polynomial_count(p);
    for (int i = 0; i < places->n; i++)
        polynomial_terms(p, places->at + 2 * (size_t)i, basis + (size_t)i * (size_t)terms);
    return least_squares_matrix(basis, weight, places->n, terms, m);
}

/* Set planes[terms] to the sums of the spectra by the matrix. */
static void combine(const mode_spectra *s, const double *m, int terms, double *planes) {
    const size_t n = modes(s->stamp);
    for (int t = 0; t < terms; t++, planes += n) {
        for (size_t j = 0; j < n; j++)
            planes[j] = 0.0;
        for (int i = 0; i < s->n; i++) {
            const double factor = m[t * s->n + i];
            const double *power = mode_spectra_of(s, i);
            for (size_t j = 0; factor != 0.0 && j < n; j++)
                planes[j] += factor * power[j];
        }
    }
}

int mode_fit(psf_chip *c, const psf_places *places, const mode_spectra *s, int degree, sf_place at,
             shear_error *err) {
    CLEANUP(release_free) double *basis = calloc((size_t)s->n * MOST_TERMS, sizeof *basis);
    CLEANUP(release_free) double *m = calloc((size_t)s->n * MOST_TERMS, sizeof *m);
    if (basis == NULL || m == NULL)
        return sf_fail_memory(err, at);
    c->terms = polynomial_of(2, degree);
    while (!fit_matrix(&c->terms, places, s->weight, basis, m)) {
        if (degree == 0)
            return sf_fail(err, SHEAR_E_PSF, at, NULL, "no image of the PSF can be used");
        degree--;
        c->terms = polynomial_of(2, degree);
    }
    const int terms = polynomial_count(&c->terms);
    free(c->samples);
    c->samples = calloc((size_t)terms * modes(s->stamp), sizeof *c->samples);
    if (c->samples == NULL)
        return sf_fail_memory(err, at);
    combine(s, m, terms, c->samples);
    c->model = (shear_psf_model){
        .nx = s->stamp, .ny = s->stamp, .terms = terms, .axes = SHEAR_PSF_AXES_MODES, .step = 1.0};
    return SHEAR_OK;
}

void mode_fit_at(const psf_chip *c, const psf_places *places, int i, double *power) {
    double t[MOST_TERMS];
    const size_t n = modes(c->model.nx);
    polynomial_terms(&c->terms, places->at + 2 * (size_t)i, t);
    for (size_t j = 0; j < n; j++) {
        power[j] = 0.0;
        for (int k = 0; k < c->model.terms; k++)
            power[j] += t[k] * c->samples[(size_t)k * n + j];
    }
}
