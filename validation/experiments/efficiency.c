/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beyond the paper: the ratio of means against PDF symmetrization: errors against the Cramer-Rao
 * bound, and bias at low signal-to-noise. */
#include "engine/experiment.h"
#include "engine/must.h"
#include "experiments/efficiency_fields.h"
#include "report/chart.h"
#include "report/run.h"

#include <math.h>
#include <stdlib.h>

static const struct knob knobs[] = {
    {"ranges", "1,3,10,30,100", 1, 1e6, true, "largest flux over the smallest"},
    {"slope", "2.5", 0, 10, false, "of the fluxes' power law, dn/dF ~ F^-slope"},
    {"snr", "10", 0.1, 1e6, false, "signal-to-noise of the faintest, where there is noise"},
    {"bias-snr", "5,7,10,20,40", 0.1, 1e6, true, "of equal galaxies, for the bias"},
    {0}};

static const char *const fixed[] = {"white",     "photons", "photon-snr", "noise-ratio",
                                    "estimator", "rotate",  NULL};

static void defaults(struct request *r) {
    shear_mock_spec *m = &r->mock;
    m->nx = m->ny = 48;
    m->g1 = 0.03;
    m->g2 = -0.03;
    m->rotate = 1;
    m->galaxy = SHEAR_MOCK_IRREGULAR;
    m->r_gal_px = 5.0;
    m->r_psf_px = 1.5;
    m->steps = 300;
    m->step_px = 0.6;
    r->galaxies = 400000;
    r->groups = 40;
    r->settings.interpolation = SHEAR_INTERP_NONE;
    r->settings.filter = SHEAR_FILTER_NONE;
}

/* ---- table and figure ---- */

static void add_columns(struct table *t) {
    table_column(t, "flux_range", TABLE_NUMBER, 0, "", "largest flux over the smallest");
    table_column(t, "snr", TABLE_NUMBER, 0, "", "signal-to-noise of the faintest; nan = no noise");
    table_column(t, "estimator", TABLE_TEXT, 0, "", "mean, pdf-sym, or pdf-sym-cross");
    table_column(t, "error", TABLE_NUMBER, 4, "", "scatter of the fields times sqrt(galaxies)");
    table_column(t, "error_err", TABLE_NUMBER, 4, "", "its 1-sigma error");
    table_column(t, "quoted", TABLE_NUMBER, 4, "", "mean quoted error times sqrt(galaxies)");
    table_column(t, "pull_width", TABLE_NUMBER, 3, "", "width of (measured - true) / error");
    table_column(t, "over_bound", TABLE_NUMBER, 3, "",
                 "quoted error over the bound of one component; nan with noise");
    table_column(t, "m", TABLE_NUMBER, 5, "", "multiplicative bias, from opposite shears");
    table_column(t, "m_err", TABLE_NUMBER, 5, "", "its 1-sigma error");
    table_column(t, "failed", TABLE_INTEGER, 0, "", "fields without a shear");
}

/* Panels: errors without and with noise, bias; curves by estimator. */
struct curves {
    struct curve error[2][N_KINDS], bias[N_KINDS];
};

struct summary {
    double line, plane; /* bounds */
    double worst;       /* largest error of pdf-sym over the mean's */
    double broad;       /* over the bound, noise-free, at the broadest */
};

static void add_row(struct table *t, const struct cases *cases, int c, int kind, double bound,
                    const struct outcome *o) {
    table_number(t, cases->c[c].range);
    table_number(t, cases->snr[c]);
    table_text(t, shear_estimator_name((enum shear_estimator)kind));
    table_number(t, o->error.width);
    table_number(t, o->error.width_err);
    table_number(t, o->quoted);
    table_number(t, o->pull_width);
    table_number(t, isnan(cases->snr[c]) ? o->quoted / bound : NAN);
    table_number(t, o->m.mean);
    table_number(t, o->m.mean_err);
    table_number(t, o->failed);
}

static void add_point(struct curves *curves, const struct cases *cases, int c, int kind,
                      const struct outcome *o) {
    if (c < 2 * cases->n_ranges) {
        curve_add(&curves->error[c % 2][kind], cases->c[c].range, o->quoted, o->error.width_err);
    } else {
        curve_add(&curves->bias[kind], cases->snr[c], 100.0 * o->m.mean, 100.0 * o->m.mean_err);
    }
}

static void tabulate(const struct fields *fields, const double *values, struct table *t,
                     struct curves *curves, struct summary *s) {
    shape_counts counts;
    fields_shapes(fields, values, &counts);
    s->line = shape_bound_line(&counts);
    s->plane = shape_bound_plane(&counts);
    add_columns(t);
    for (int c = 0; c < fields->cases.n; c++) {
        double mean = NAN;
        for (int kind = 0; kind < N_KINDS; kind++) {
            if (kind == CROSSED && isnan(fields->cases.snr[c])) {
                continue;
            }
            const struct outcome o = fields_outcome(fields, values, c, kind);
            add_row(t, &fields->cases, c, kind, s->line, &o);
            add_point(curves, &fields->cases, c, kind, &o);
            mean = kind == MEAN ? o.quoted : mean;
            if (kind == SYMMETRY) {
                s->worst = fmax(s->worst, o.quoted / mean);
                s->broad = c == 2 * fields->cases.n_ranges - 2 ? o.quoted / s->line : s->broad;
            }
        }
    }
    table_meta(t, "bound_one_component", "%.5f", s->line);
    table_meta(t, "bound_both_components", "%.5f", s->plane);
    table_meta(t, "verdict",
               "Cramer-Rao bound for one galaxy %.4f (both components together: %.4f); pdf-sym "
               "without noise at the broadest fluxes: %.3f times that; its error is at most %.3f "
               "times that of the ratio of means",
               s->line, s->plane, s->broad, s->worst);
}

static int draw(struct curves *curves, const struct summary *s, shear_figure **figure,
                shear_error *err) {
    static const int hues[N_KINDS] = {SHEAR_BLUE, SHEAR_VERMILION, SHEAR_GREEN};
    static const int markers[N_KINDS] = {SHEAR_SQUARE, SHEAR_DISC, SHEAR_TRIANGLE};
    const shear_grid grid = {.area = {8, 8, 744, 824}, .rows = 3, .columns = 1, .gap_y = 8};
    const int code = shear_figure_new(figure, 760, 840, err);
    struct curve *const panels[] = {curves->error[0], curves->error[1], curves->bias};
    for (int p = 0; code == SHEAR_OK && p < 3; p++) {
        for (int kind = 0; kind < N_KINDS; kind++) {
            panels[p][kind].hue = hues[kind];
            panels[p][kind].marker = markers[kind];
            panels[p][kind].label =
                p == 0 && kind == CROSSED ? NULL : shear_estimator_name((enum shear_estimator)kind);
        }
        chart_draw(*figure, &(struct chart){
                                .cell = shear_grid_cell(&grid, p, 0, 1, 1),
                                .title = p == 0   ? "without noise; dotted: Cramer-Rao bound"
                                         : p == 1 ? "with noise"
                                                  : "bias of equal galaxies",
                                .x_label = p < 2 ? "largest over smallest flux" : "signal-to-noise",
                                .y_label = p < 2 ? "error of one galaxy" : "m, percent",
                                .log_x = true,
                                .legend = p < 2 ? SHEAR_TOP_LEFT : SHEAR_BOTTOM_RIGHT,
                                .truth = p == 0   ? s->line
                                         : p == 1 ? NAN
                                                  : 0.0,
                                .spread = 0.01,
                                .n_curves = p == 0 ? 2 : N_KINDS,
                                .curves = panels[p]});
    }
    return code;
}

static int finish(const struct fields *fields, const struct ledger *ledger, const double *values,
                  shear_error *err) {
    struct table *t = table_new(fields->r);
    struct summary s = {0};
    shear_figure *f = NULL;
    int code = SHEAR_OK;
    struct curves *curves = memory_new(1, sizeof *curves, "the figure", &code, err);
    if (code == SHEAR_OK) {
        tabulate(fields, values, t, curves, &s);
        code = draw(curves, &s, &f, err);
    }
    code = code != SHEAR_OK ? code : report_save(fields->r, ledger, t, f, err);
    shear_figure_free(f);
    free(curves);
    table_free(t);
    return code;
}

static int exec(const struct request *r, shear_error *err) {
    struct ledger *ledger = NULL;
    struct fields fields;
    double *values = NULL;
    int code = fields_init(&fields, r, err);
    const int per_field = fields_values(&fields);
    if (code == SHEAR_OK) {
        values = calloc((size_t)r->groups * (size_t)per_field, sizeof *values);
        code = values != NULL
                   ? ledger_open(&ledger, r, 2 * (int64_t)fields.count * r->groups, err)
                   : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the fields' shears");
    }
    const struct task task = {.name = "fields",
                              .chunks = r->groups,
                              .values = per_field,
                              .stamps_of_chunk = 2 * fields.count,
                              .work = fields_work,
                              .context = &fields};
    code = code != SHEAR_OK ? code : ledger_run(ledger, &task, values, err);
    code = code != SHEAR_OK ? code : finish(&fields, ledger, values, err);
    ledger_close(ledger);
    free(values);
    fields_deinit(&fields);
    return code;
}

const experiment exp_efficiency = {
    .name = "efficiency",
    .summary = "beyond the paper: the ratio of means against PDF symmetrization",
    .about =
        "Irregular galaxies, each at many fluxes, in many fields (--groups) of equal size. The\n"
        "error of one galaxy by the ratio of means and by PDF symmetrization, over power laws\n"
        "of flux from equal galaxies to a broad range, with and without white noise, beside\n"
        "the Cramer-Rao bound of the galaxies' shapes; and the bias of both against the\n"
        "signal-to-noise of equal galaxies, with the same galaxies and noise at opposite\n"
        "shears.",
    .knobs = knobs,
    .fixed = fixed,
    .defaults = defaults,
    .exec = exec,
};
