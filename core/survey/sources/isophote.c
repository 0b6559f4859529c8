/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/sources/isophote.h"

#include "base/cleanup.h"

#include <math.h>

static const double half_light_radii = 2.5;
static const double deviations = 3.0;
static const double margin = 1.25;

static bool positive(double v) {
    return v > 0.0 && isfinite(v);
}

static bool has_axes(const source_columns *c) {
    return c->by[SOURCE_A] != NULL;
}

static const sf_column *flux_radius(const source_columns *c) {
    return source_columns_number(c->table, "FLUX_RADIUS");
}

bool isophote_known(const source_columns *c) {
    return has_axes(c) || flux_radius(c) != NULL;
}

/* Read a further column; NaN if it is absent. */
static int read_optional(const source_columns *c, const char *name, double *out, shear_error *err) {
    const sf_column *column = source_columns_number(c->table, name);
    if (column != NULL)
        return sf_table_doubles(c->table, column, c->first, c->n, out, err);
    for (int64_t i = 0; i < c->n; i++)
        out[i] = NAN;
    return SHEAR_OK;
}

static int scale(const source_columns *c, double *a, double *b, shear_error *err) {
    const int64_t n = c->n;
    CLEANUP(release_free) double *kron = calloc((size_t)n + 1, sizeof *kron);
    CLEANUP(release_free) double *area = calloc((size_t)n + 1, sizeof *area);
    if (kron == NULL || area == NULL)
        return sf_fail_memory(err, c->table->cards->at);
    TRY(read_optional(c, "KRON_RADIUS", kron, err));
    TRY(read_optional(c, "ISOAREA_IMAGE", area, err));
    for (int64_t i = 0; i < n; i++) {
        const double of_area = margin * sqrt(area[i] / (M_PI * a[i] * b[i]));
        const double larger =
            fmax(positive(kron[i]) ? kron[i] : 0.0, positive(of_area) ? of_area : 0.0);
        const double factor = larger > 0.0 ? larger : deviations;
        a[i] *= factor;
        b[i] *= factor;
    }
    return SHEAR_OK;
}

static int read_circles(const source_columns *c, double *a, double *b, double *theta,
                        shear_error *err) {
    TRY(sf_table_doubles(c->table, flux_radius(c), c->first, c->n, a, err));
    for (int64_t i = 0; i < c->n; i++) {
        b[i] = a[i] *= half_light_radii;
        theta[i] = 0.0;
    }
    return SHEAR_OK;
}

static int read_ellipses(const source_columns *c, double *a, double *b, double *theta,
                         shear_error *err) {
    TRY(source_columns_read(c, SOURCE_A, a, err));
    TRY(source_columns_read(c, SOURCE_B, b, err));
    TRY(source_columns_read(c, SOURCE_THETA, theta, err));
    return source_columns_is(c, SOURCE_A, "A_IMAGE") ? scale(c, a, b, err) : SHEAR_OK;
}

int isophote_read(const source_columns *c, double *a, double *b, double *theta, shear_error *err) {
    TRY(has_axes(c) ? read_ellipses(c, a, b, theta, err) : read_circles(c, a, b, theta, err));
    for (int64_t i = 0; i < c->n; i++) {
        if (!positive(a[i]) || !positive(b[i]))
            a[i] = b[i] = NAN;
    }
    return SHEAR_OK;
}
