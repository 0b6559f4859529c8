/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiments/efficiency_fields.h"

#include "engine/must.h"
#include "shear/symmetry.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(shape_counts) == SHAPE_VALUES * sizeof(double), "plain doubles");

/* ---- the cases ---- */

static void add_case(brightness_cases *all, double range, double slope, double sigma, double snr) {
    all->c[all->n] = (brightness){.range = range, .slope = slope, .sigma = sigma};
    all->snr[all->n++] = snr;
}

static brightness_cases list_cases(const options *o) {
    const parameter_values *ranges = options_list(o, "ranges");
    const parameter_values *bias = options_list(o, "bias-snr");
    const double slope = options_number(o, "slope");
    const double snr = options_number(o, "snr");
    const double unit = brightness_sigma(&o->mock, 1.0);
    brightness_cases all = {.n_ranges = ranges->n};
    for (int i = 0; i < ranges->n; i++) {
        add_case(&all, ranges->v[i], slope, 0.0, NAN);
        add_case(&all, ranges->v[i], slope, unit / snr, snr);
    }
    for (int i = 0; i < bias->n; i++)
        add_case(&all, 1.0, slope, unit / bias->v[i], bias->v[i]);
    return all;
}

/* ---- drawing and estimating ---- */

/* A running measurement of fields. */
typedef struct measuring {
    const efficiency_fields *of;
    brightness_stamps *stamps[2]; /* at the shear, and at the opposite shear */
    double beta_px;
    double typical_d; /* of a galaxy of flux 1 without noise */
    shear_row *rows;  /* [cases.n][count] */
} measuring;

/* Return the median D of the first galaxies. */
static double find_typical_d(brightness_stamps *s) {
    enum { N = 64 };
    shear_row rows[N];
    const brightness one = {.range = 1.0};
    double median = 0.0;
    brightness_stamps_rows(s, 0, N, 1, &one, rows);
    for (int i = 0; i < N; i++) {
        int below = 0;
        for (int k = 0; k < N; k++)
            below += rows[k].d < rows[i].d;
        median = below == N / 2 ? rows[i].d : median;
    }
    return median;
}

static void prepare(measuring *m) {
    const efficiency_fields *f = m->of;
    const options *o = f->options;
    const size_t n = (size_t)f->cases.n * (size_t)f->count;
    shear_settings settings = o->settings;
    settings.estimator =
        SHEAR_ESTIMATOR_PDF_SYM_CROSS; /* its rows contain all that the other estimators need */
    for (int k = 0; k < 2; k++) {
        shear_mock_spec mock = o->mock;
        mock.n_stamps = (int64_t)f->count * o->groups;
        mock.g1 = k != 0 ? -mock.g1 : mock.g1;
        mock.g2 = k != 0 ? -mock.g2 : mock.g2;
        m->stamps[k] = brightness_stamps_new(&mock, &settings, o->threads);
    }
    m->rows = must_allocate(n, sizeof *m->rows, "a field's rows");
    m->beta_px = brightness_stamps_beta_px(m->stamps[0]);
    m->typical_d = find_typical_d(m->stamps[0]);
}

static shear_row without_cross(const shear_row *row) {
    shear_row plain = *row;
    plain.cross_n1 = plain.cross_n2 = plain.cross_d = plain.cross_u = plain.cross_v = 0.0;
    return plain;
}

/* Estimate the shear of one field by one estimator. */
static void estimate(const shear_row *rows, int count, double beta_px, int estimator,
                     double out[EFFICIENCY_PER_ESTIMATE]) {
    shear_field_sums *sums = NULL;
    shear_symmetry *terms = NULL;
    shear_result s = {0};
    must(shear_field_sums_new(&sums, &must_error));
    if (estimator != MEAN)
        must(shear_symmetry_new(&terms, &must_error));
    for (int i = 0; i < count; i++) {
        const shear_row row = estimator == CROSSED ? rows[i] : without_cross(&rows[i]);
        shear_block_sums block;
        shear_block_sums_init(&block);
        shear_block_sums_add(&block, &row);
        shear_field_sums_add(sums, &block);
        if (terms != NULL)
            must(shear_symmetry_add(terms, &row, beta_px, &must_error));
    }
    must(shear_estimate((enum shear_estimator)estimator, sums, terms, &s, &must_error));
    out[0] = s.g1;
    out[1] = s.g2;
    out[2] = s.g1_err;
    out[3] = s.g2_err;
    shear_symmetry_free(terms);
    shear_field_sums_free(sums);
}

/* Return the index of an estimate in a field's values. */
static size_t place(int i_case, int estimator, int sign) {
    const int estimate = i_case * 2 * N_ESTIMATORS + estimator * 2 + sign;
    return (size_t)estimate * EFFICIENCY_PER_ESTIMATE;
}

/* Count the shapes of the galaxies without noise, with the shear subtracted. */
static void count_shapes(const measuring *m, int64_t first, double *values) {
    const efficiency_fields *f = m->of;
    const double beta2 = m->beta_px * m->beta_px;
    const double g1 = f->options->mock.g1;
    const double g2 = f->options->mock.g2;
    shape_counts counts = {0};
    for (int i = 0; i < f->count; i++) {
        const shear_row *row = &m->rows[i];
        const double u = -0.5 * beta2 * row->u;
        const double v = -2.0 * beta2 * row->v;
        const double flux = brightness_flux(&f->cases.c[0], f->options->mock.seed, first + i);
        shape_counts_add(&counts, row->d / (flux * flux * m->typical_d),
                         (row->n1 - g2 * v) / (row->d + u) - g1,
                         (row->n2 - g1 * v) / (row->d - u) - g2);
    }
    memcpy(values, &counts, sizeof counts);
}

static int values_of_field(const efficiency_fields *f) {
    return f->cases.n * EFFICIENCY_PER_CASE + SHAPE_VALUES;
}

static void measure_field(void *context, int field, double *values) {
    const measuring *m = context;
    const efficiency_fields *f = m->of;
    const int64_t first = (int64_t)field * f->count;
    for (int sign = 0; sign < 2; sign++) {
        brightness_stamps_rows(m->stamps[sign], first, f->count, f->cases.n, f->cases.c, m->rows);
        for (int i = 0; i < f->cases.n * N_ESTIMATORS; i++) {
            const int c = i / N_ESTIMATORS;
            estimate(m->rows + (size_t)c * (size_t)f->count, f->count, m->beta_px, i % N_ESTIMATORS,
                     values + place(c, i % N_ESTIMATORS, sign));
        }
        if (sign == 0)
            count_shapes(m, first, values + f->cases.n * EFFICIENCY_PER_CASE);
    }
}

int efficiency_fields_count(const options *o) {
    const int count = (int)(o->galaxies / o->groups);
    if (count < 100) {
        must_fail(SHEAR_E_SETTING, "ask for more galaxies or fewer groups",
                  "a field has %d galaxies; 100 are needed", count);
    }
    return count;
}

void efficiency_fields_init(efficiency_fields *f, const options *o, cache *c) {
    *f = (efficiency_fields){
        .options = o, .cases = list_cases(o), .count = efficiency_fields_count(o)};
    measuring m = {.of = f};
    prepare(&m);
    f->values = cache_run(c, &(cache_task){"fields", o->groups, values_of_field(f),
                                           .stamps_of_chunk = 2 * f->count, .work = measure_field,
                                           .context = &m});
    brightness_stamps_free(m.stamps[0]);
    brightness_stamps_free(m.stamps[1]);
    free(m.rows);
}

void efficiency_fields_deinit(efficiency_fields *f) {
    free(f->values);
}

/* ---- results ---- */

efficiency_outcome efficiency_fields_outcome(const efficiency_fields *f, int i_case,
                                             int estimator) {
    const int n_fields = f->options->groups;
    const double truth[2] = {f->options->mock.g1, f->options->mock.g2};
    const double root = sqrt((double)f->count);
    efficiency_outcome o = {.failed = 0};
    CLEANUP(release_free)
    double *error = must_allocate(6 * (size_t)n_fields, sizeof *error, "errors");
    double *pull = error + 2 * n_fields;
    double *m = error + 4 * n_fields;
    size_t n = 0;
    for (int i = 0; i < n_fields; i++) {
        const double *field = f->values + (size_t)i * (size_t)values_of_field(f);
        const double *plus = field + place(i_case, estimator, 0);
        const double *minus = field + place(i_case, estimator, 1);
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
    o.error = spread_of(error, n);
    o.pull_width = spread_of(pull, n).width;
    o.m = spread_of(m, n);
    o.quoted /= (double)n;
    return o;
}

shape_counts efficiency_fields_shapes(const efficiency_fields *f) {
    const size_t per_field = (size_t)values_of_field(f);
    double sum[SHAPE_VALUES] = {0.0};
    shape_counts counts;
    for (int i = 0; i < f->options->groups; i++) {
        const double *shapes = f->values + (size_t)(i + 1) * per_field - SHAPE_VALUES;
        for (int k = 0; k < SHAPE_VALUES; k++)
            sum[k] += shapes[k];
    }
    memcpy(&counts, sum, sizeof counts);
    return counts;
}
