/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/places.h"

#include "base/cleanup.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Names of the pairs of columns, the first found is used. */
static const char *const names[][2] = {
    {"X", "Y"},    {"X_IMAGE", "Y_IMAGE"},         {"XWIN_IMAGE", "YWIN_IMAGE"},
    {"RA", "DEC"}, {"ALPHA_J2000", "DELTA_J2000"}, {"ALPHAWIN_J2000", "DELTAWIN_J2000"}};
enum { PAIRS = sizeof names / sizeof names[0], PIXEL_PAIRS = 3 };

int psf_places_find(const psf_record *r, const sf_column *columns[2], bool *sky, shear_error *err) {
    columns[0] = columns[1] = NULL;
    *sky = false;
    for (int pair = 0; pair < PAIRS && columns[0] == NULL; pair++) {
        for (int i = 0; i < 2; i++)
            TRY(sf_table_find_numbers(&r->table, names[pair][i], &columns[i], err));
        if ((columns[0] == NULL) != (columns[1] == NULL)) {
            return psf_record_fail(r, names[pair][columns[0] == NULL ? 0 : 1],
                                   "is missing, but there is its partner", err);
        }
        *sky = pair >= PIXEL_PAIRS;
    }
    return SHEAR_OK;
}

/* Read a column into out[n][2]. */
static int read_column(const psf_record *r, const sf_column *column, int n, double *out,
                       shear_error *err) {
    const bool cell = r->rows == 1 && column->repeat == n;
    char what[96];
    if (!cell && (r->rows != n || column->repeat != 1)) {
        snprintf(what, sizeof what, "has %lld rows of %lld numbers, but there are %d images",
                 (long long)r->rows, (long long)column->repeat, n);
        return psf_record_fail(r, column->name, what, err);
    }
    CLEANUP(release_free) double *values = calloc((size_t)n, sizeof *values);
    if (values == NULL)
        return sf_fail_memory(err, r->cards.at);
    TRY(cell ? sf_table_cell(&r->table, column, 0, values, err)
             : sf_table_doubles(&r->table, column, 0, n, values, err));
    for (int i = 0; i < n; i++) {
        if (!(fabs(values[i]) < 1e9))
            return psf_record_fail(r, column->name, "has a number that is no position", err);
        out[2 * i] = values[i];
    }
    return SHEAR_OK;
}

int psf_places_init(psf_places *p, const psf_record *r, int n, shear_error *err) {
    const sf_column *columns[2];
    *p = (psf_places){.n = n};
    TRY(psf_places_find(r, columns, &p->sky, err));
    if (columns[0] == NULL)
        return psf_record_fail(r, "X", "is missing (X and Y, or RA and DEC, of each image)", err);
    p->at = calloc((size_t)n, 2 * sizeof *p->at);
    if (p->at == NULL)
        return sf_fail_memory(err, r->cards.at);
    for (int i = 0; i < 2; i++)
        TRY(read_column(r, columns[i], n, p->at + i, err));
    return SHEAR_OK;
}

void psf_places_deinit(psf_places *p) {
    free(p->at);
    p->at = NULL;
}

/* Project the places to the tangent plane at their middle: that of the unit vectors. */
static void project(psf_places *p, psf_chip *c) {
    const double degree = acos(-1.0) / 180.0;
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
    for (int i = 0; i < p->n; i++) {
        const double *at = p->at + 2 * i;
        x += cos(at[1] * degree) * cos(at[0] * degree);
        y += cos(at[1] * degree) * sin(at[0] * degree);
        z += sin(at[1] * degree);
    }
    c->ra0 = atan2(y, x) / degree;
    c->dec0 = atan2(z, hypot(x, y)) / degree;
    for (int i = 0; i < p->n; i++) {
        double *at = p->at + 2 * i;
        psf_chip_tangent(c, at[0], at[1], &at[0], &at[1]);
    }
}

static void set_range(const psf_places *p, int i, psf_variable *v) {
    double min = INFINITY;
    double max = -INFINITY;
    for (int k = 0; k < p->n; k++) {
        min = fmin(min, p->at[2 * k + i]);
        max = fmax(max, p->at[2 * k + i]);
    }
    v->zero = v->middle = 0.5 * (min + max);
    v->width = max > min ? max - min : INFINITY;
    v->scale = max > min ? 0.5 * (max - min) : 1.0;
}

void psf_places_set_variables(psf_places *p, psf_chip *c) {
    if (p->sky)
        project(p, c);
    c->terms = polynomial_of(2, 0);
    for (int i = 0; i < 2; i++) {
        psf_variable *v = &c->variables[i];
        psf_chip_set_variable(c, i, (const char *[]){"x", "y", "u", "v"}[(p->sky ? 2 : 0) + i]);
        set_range(p, i, v);
        for (int k = 0; k < p->n; k++)
            p->at[2 * k + i] = (p->at[2 * k + i] - v->zero) / v->scale;
    }
}
