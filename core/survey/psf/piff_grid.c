/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/piff_grid.h"

#include "base/cleanup.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of files that do not say which; they are older than the column `interp`. */
enum { OLD_LANCZOS = 3, MOST_LANCZOS = 20 };

/* Read n of "Lanczos(n)", "galsim.Lanczos(n, True, ...)". */
static int read_lanczos(psf_chip *c, const psf_record *model, const char *advice,
                        shear_error *err) {
    char text[240];
    TRY(psf_record_text(model, "interp", text, sizeof text, err));
    const char *at = strstr(text, "Lanczos(");
    const char *digits = at != NULL ? at + strlen("Lanczos(") : "0";
    digits += strncmp(digits, "n=", 2) == 0 ? 2 : 0;
    c->model.lanczos = text[0] == '\0' ? OLD_LANCZOS : (int)strtol(digits, NULL, 10);
    if (c->model.lanczos >= 1 && c->model.lanczos <= MOST_LANCZOS)
        return SHEAR_OK;
    return sf_fail(err, SHEAR_E_PSF, model->cards.at, advice,
                   "the interpolant %.80s of Piff is not read, only Lanczos(1) to Lanczos(%d)",
                   text, MOST_LANCZOS);
}

static int read_size(psf_chip *c, const psf_record *model, shear_error *err) {
    int size = 0;
    TRY(psf_record_int(model, "size", 3, PSF_SIDE, &size, err));
    if (size == 0)
        return psf_record_fail(model, "size", "is missing", err);
    TRY(psf_record_double(model, "scale", &c->model.step, err));
    if (!(c->model.step > 1e-6 && c->model.step < 1e6))
        return psf_record_fail(model, "scale", "must be a positive number of arcsec", err);
    c->model.nx = c->model.ny = size;
    c->model.axes = SHEAR_PSF_AXES_SKY;
    return SHEAR_OK;
}

/* Return how many pixels the parameters leave out: 0; 1, the centre; or 3, with the ones above and
 * to its right. Return -1 if the number of parameters is another. */
static int left_out(int64_t pixels, int64_t parameters) {
    const int64_t n = pixels - parameters;
    return n == 0 || n == 1 || n == 3 ? (int)n : -1;
}

/* A plane of the grid: sample [v][u], with the origin at [n/2][n/2]. */
typedef struct grid_plane {
    double *samples;
    int n;
} grid_plane;

static bool is_solved(const grid_plane *g, int left, int v, int u) {
    const int o = g->n / 2;
    return (left >= 1 && v == o && u == o) ||
           (left == 3 && ((v == o + 1 && u == o) || (v == o && u == o + 1)));
}

/* Solve for the pixels that are left out: the flux is `flux`, and both first moments are 0. */
static void solve(const grid_plane *g, int left, double flux) {
    const int n = g->n;
    const int o = n / 2;
    double sum = 0.0;
    double up = 0.0;
    double right = 0.0;
    for (int v = 0; v < n; v++) {
        for (int u = 0; u < n; u++) {
            const double p = g->samples[v * n + u];
            sum += p;
            up += (v - o) * p;
            right += (u - o) * p;
        }
    }
    if (left == 3) {
        g->samples[(o + 1) * n + o] = -up;
        g->samples[o * n + o + 1] = -right;
        sum -= up + right;
    }
    g->samples[o * n + o] = flux - sum;
}

/* Fill plane t from q[parameter][terms], in the order of rows. */
static void fill(const grid_plane *g, int left, const double *q, int terms, int t) {
    for (int i = 0; i < g->n * g->n; i++) {
        if (is_solved(g, left, i / g->n, i % g->n))
            continue;
        g->samples[i] = q[t];
        q += terms;
    }
}

/* Check the shape of q, [parameters][terms]. A vector without TDIMn has one term. */
static int check_shape(const psf_chip *c, const psf_record *solution, int64_t axes[SF_AXES],
                       shear_error *err) {
    char what[160];
    const int size = c->model.nx;
    const int terms = polynomial_count(&c->terms);
    if (terms == 1 && axes[1] == 1 && axes[2] == 1) {
        axes[1] = axes[0];
        axes[0] = 1;
    }
    if (axes[2] == 1 && axes[0] == terms && terms <= POLYNOMIAL_TERMS &&
        left_out((int64_t)size * size, axes[1]) >= 0)
        return SHEAR_OK;
    snprintf(
        what, sizeof what,
        "has %lld terms of %lld parameters, but the polynomial has %d%s, and a grid of %d x %d "
        "has n^2, n^2 - 1 or n^2 - 3",
        (long long)axes[0], (long long)axes[1], terms, terms > POLYNOMIAL_TERMS ? " or more" : "",
        size, size);
    return psf_record_fail(solution, "q", what, err);
}

int piff_grid_read(psf_chip *c, const psf_record *model, const psf_record *solution,
                   const char *advice, shear_error *err) {
    CLEANUP(release_free) double *q = NULL;
    int64_t axes[SF_AXES];
    TRY(read_lanczos(c, model, advice, err));
    TRY(read_size(c, model, err));
    TRY(psf_record_array(solution, "q", axes, &q, err));
    TRY(check_shape(c, solution, axes, err));
    const size_t plane = (size_t)c->model.nx * (size_t)c->model.ny;
    const int left = left_out((int64_t)plane, axes[1]);
    c->model.terms = (int)axes[0];
    c->samples = calloc(plane * (size_t)c->model.terms, sizeof *c->samples);
    if (c->samples == NULL)
        return sf_fail_memory(err, solution->cards.at);
    for (int t = 0; t < c->model.terms; t++) {
        const grid_plane g = {c->samples + (size_t)t * plane, c->model.nx};
        fill(&g, left, q, c->model.terms, t);
        if (left > 0) /* the flux, 1 for an area of step^2, belongs to the constant term */
            solve(&g, left, t == 0 ? 1.0 / (c->model.step * c->model.step) : 0.0);
    }
    return SHEAR_OK;
}
