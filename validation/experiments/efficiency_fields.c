/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiments/efficiency_fields.h"
#include "engine/must.h"

#include "shear/symmetry.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(shape_counts) == SHAPE_VALUES * sizeof(double), "plain doubles");

/* ---- the cases ---- */

static void cases_add(struct cases *cases, double range, double slope, double sigma, double snr) {
    cases->c[cases->n] = (brightness){.range = range, .slope = slope, .sigma = sigma};
    cases->snr[cases->n++] = snr;
}

static int cases_init(struct cases *cases, const struct request *r, shear_error *err) {
    const knob_values *ranges = request_list(r, "ranges");
    const knob_values *bias = request_list(r, "bias-snr");
    const double slope = request_number(r, "slope");
    const double snr = request_number(r, "snr");
    double unit;
    const int code = brightness_sigma(&r->mock, 1.0, &unit, err);
    *cases = (struct cases){.n_ranges = ranges->n};
    for (int i = 0; i < ranges->n; i++) {
        cases_add(cases, ranges->v[i], slope, 0.0, NAN);
        cases_add(cases, ranges->v[i], slope, unit / snr, snr);
    }
    for (int i = 0; i < bias->n; i++) {
        cases_add(cases, 1.0, slope, unit / bias->v[i], bias->v[i]);
    }
    return code;
}

/* ---- drawing and estimating ---- */

/* The median D of the first galaxies. */
static int set_typical(struct fields *fields, shear_error *err) {
    enum { N = 64 };
    shear_row rows[N];
    const brightness one = {.range = 1.0};
    const int code = bright_stamps_rows(fields->stamps[0], 0, N, 1, &one, rows, err);
    for (int i = 0; i < N; i++) {
        int below = 0;
        for (int k = 0; k < N; k++) {
            below += rows[k].d < rows[i].d;
        }
        fields->typical_d = below == N / 2 ? rows[i].d : fields->typical_d;
    }
    return code;
}

int fields_init(struct fields *fields, const struct request *r, shear_error *err) {
    *fields = (struct fields){.r = r, .count = (int)(r->galaxies / r->groups)};
    shear_settings settings = r->settings;
    settings.estimator = SHEAR_ESTIMATOR_PDF_SYM_CROSS; /* its rows have all that the others need */
    int code = cases_init(&fields->cases, r, err);
    if (code == SHEAR_OK && fields->count < 100) {
        return shear_fail(err, SHEAR_E_SETTING, "ask for more galaxies or fewer groups",
                          "a field has %d galaxies; 100 are needed", fields->count);
    }
    for (int k = 0; code == SHEAR_OK && k < 2; k++) {
        shear_mock_spec m = r->mock;
        m.n_stamps = (int64_t)fields->count * r->groups;
        m.g1 = k != 0 ? -m.g1 : m.g1;
        m.g2 = k != 0 ? -m.g2 : m.g2;
        code = bright_stamps_new(&fields->stamps[k], &m, &settings, r->threads, err);
    }
    const size_t n = (size_t)fields->cases.n * (size_t)fields->count;
    fields->rows = memory_new(n, sizeof *fields->rows, "a field's rows", &code, err);
    return code != SHEAR_OK ? code : set_typical(fields, err);
}

void fields_deinit(struct fields *fields) {
    bright_stamps_free(fields->stamps[0]);
    bright_stamps_free(fields->stamps[1]);
    free(fields->rows);
}

static shear_row without_cross(const shear_row *row) {
    shear_row plain = *row;
    plain.cross_n1 = plain.cross_n2 = plain.cross_d = plain.cross_u = plain.cross_v = 0.0;
    return plain;
}

/* One field's shear by one estimator, into out[EFFICIENCY_PER_KIND]. */
static int estimate(const shear_row *rows, int count, double beta, int kind, double *out,
                    shear_error *err) {
    const bool symmetric = kind != MEAN;
    shear_field_sums *sums = NULL;
    shear_symmetry *terms = NULL;
    shear_result s = {0};
    int code = shear_field_sums_new(&sums, err);
    code = code != SHEAR_OK || !symmetric ? code : shear_symmetry_new(&terms, err);
    for (int i = 0; code == SHEAR_OK && i < count; i++) {
        shear_block_sums block;
        const shear_row row = kind == CROSSED ? rows[i] : without_cross(&rows[i]);
        shear_block_sums_init(&block);
        shear_block_sums_add(&block, &row);
        shear_field_sums_add(sums, &block);
        code = symmetric ? shear_symmetry_add(terms, &row, beta, err) : SHEAR_OK;
    }
    code =
        code != SHEAR_OK ? code : shear_estimate((enum shear_estimator)kind, sums, terms, &s, err);
    const double values[EFFICIENCY_PER_KIND] = {s.g1, s.g2, s.g1_err, s.g2_err};
    memcpy(out, values, sizeof values);
    shear_symmetry_free(terms);
    shear_field_sums_free(sums);
    return code;
}

static double *slot(double *values, int c, int kind, int sign) {
    return values + c * EFFICIENCY_PER_CASE + (kind * 2 + sign) * EFFICIENCY_PER_KIND;
}

static int estimate_all(const struct fields *fields, int sign, double *values, shear_error *err) {
    const double beta = bright_stamps_plan(fields->stamps[0])->beta_px;
    int code = SHEAR_OK;
    for (int c = 0; code == SHEAR_OK && c < fields->cases.n; c++) {
        const shear_row *rows = fields->rows + (size_t)c * (size_t)fields->count;
        for (int kind = 0; code == SHEAR_OK && kind < N_KINDS; kind++) {
            code = estimate(rows, fields->count, beta, kind, slot(values, c, kind, sign), err);
        }
    }
    return code;
}

/* Shapes of the galaxies without noise, the shear taken off. */
static void count_shapes(const struct fields *fields, int64_t first, double *values) {
    const double beta = bright_stamps_plan(fields->stamps[0])->beta_px;
    const double g1 = fields->r->mock.g1;
    const double g2 = fields->r->mock.g2;
    shape_counts counts = {0};
    for (int i = 0; i < fields->count; i++) {
        const shear_row *row = &fields->rows[i];
        const double u = -0.5 * beta * beta * row->u;
        const double v = -2.0 * beta * beta * row->v;
        const double flux = brightness_flux(&fields->cases.c[0], fields->r->mock.seed, first + i);
        shape_counts_add(&counts, row->d / (flux * flux * fields->typical_d),
                         (row->n1 - g2 * v) / (row->d + u) - g1,
                         (row->n2 - g1 * v) / (row->d - u) - g2);
    }
    memcpy(values, &counts, sizeof counts);
}

int fields_values(const struct fields *fields) {
    return fields->cases.n * EFFICIENCY_PER_CASE + SHAPE_VALUES;
}

int fields_work(void *context, int field, double *values, shear_error *err) {
    struct fields *fields = context;
    int code = SHEAR_OK;
    for (int sign = 0; code == SHEAR_OK && sign < 2; sign++) {
        code =
            bright_stamps_rows(fields->stamps[sign], (int64_t)field * fields->count, fields->count,
                               fields->cases.n, fields->cases.c, fields->rows, err);
        code = code != SHEAR_OK ? code : estimate_all(fields, sign, values, err);
        if (code == SHEAR_OK && sign == 0) {
            count_shapes(fields, (int64_t)field * fields->count,
                         values + fields->cases.n * EFFICIENCY_PER_CASE);
        }
    }
    return code;
}

/* ---- what comes out ---- */

struct outcome fields_outcome(const struct fields *fields, const double *values, int c, int kind) {
    const int n_fields = fields->r->groups;
    const int per_field = fields_values(fields);
    const double truth[2] = {fields->r->mock.g1, fields->r->mock.g2};
    const double root = sqrt((double)fields->count);
    struct outcome o = {.failed = 0};
    double *error = calloc(8 * (size_t)n_fields, sizeof *error);
    double *pull = error + 2 * n_fields;
    double *m = error + 4 * n_fields;
    int n = 0;
    for (int f = 0; error != NULL && f < n_fields; f++) {
        double *field = (double *)values + (size_t)f * (size_t)per_field;
        const double *plus = slot(field, c, kind, 0);
        const double *minus = slot(field, c, kind, 1);
        if (!isfinite(plus[0] + plus[1] + minus[0] + minus[1])) {
            o.failed++;
            continue;
        }
        for (int k = 0; k < 2; k++, n++) {
            error[n] = (plus[k] - truth[k]) * root;
            pull[n] = (plus[k] - truth[k]) / plus[2 + k];
            m[n] = (plus[k] - minus[k]) / (2.0 * truth[k]) - 1.0;
            o.quoted += plus[2 + k] * root;
        }
    }
    if (error != NULL) {
        o.error = spread_of(error, (size_t)n);
        o.pull_width = spread_of(pull, (size_t)n).width;
        o.m = spread_of(m, (size_t)n);
        o.quoted /= n;
    }
    free(error);
    return o;
}

void fields_shapes(const struct fields *fields, const double *values, shape_counts *counts) {
    const size_t per_field = (size_t)fields_values(fields);
    double sum[SHAPE_VALUES] = {0.0};
    for (int f = 0; f < fields->r->groups; f++) {
        const double *shapes = values + (size_t)(f + 1) * per_field - SHAPE_VALUES;
        for (int i = 0; i < SHAPE_VALUES; i++) {
            sum[i] += shapes[i];
        }
    }
    memcpy(counts, sum, sizeof *counts);
}
