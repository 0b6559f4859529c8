/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiments/selection.h"

#include "report/chart.h"
#include "report/run.h"

#include <math.h>

static const selection_outcome *outcome(const struct request *r, const selection_outcome *out,
                                        int cut, int fraction, int estimator) {
    const int n = request_list(r, "kept")->n;
    return &out[(cut * n + fraction) * SELECTION_ESTIMATORS + estimator];
}

/* ---- table ---- */

static void add_columns(struct table *t) {
    table_column(t, "cut", TABLE_TEXT, 0, "", "what is cut on");
    table_column(t, "asked", TABLE_NUMBER, 2, "", "part of the stamps that is to be kept");
    table_column(t, "kept", TABLE_NUMBER, 3, "", "part that is");
    table_column(t, "threshold", TABLE_NUMBER, -4, "", "the least value that is kept");
    table_column(t, "estimator", TABLE_TEXT, 0, "", "mean or pdf-sym");
    table_column(t, "m", TABLE_NUMBER, 4, "", "multiplicative bias along the shear");
    table_column(t, "m_err", TABLE_NUMBER, 4, "", "its 1-sigma error");
    table_column(t, "shift", TABLE_NUMBER, 4, "", "m less that without a cut");
    table_column(t, "shift_err", TABLE_NUMBER, 4, "", "its 1-sigma error");
}

static void add_row(struct table *t, int cut, double asked, int estimator,
                    const selection_outcome *o) {
    table_text(t, selection_cuts[cut]);
    table_number(t, asked);
    table_number(t, o->kept);
    table_number(t, o->threshold);
    table_text(t, selection_estimators[estimator]);
    table_number(t, o->m);
    table_number(t, o->m_err);
    table_number(t, o->shift);
    table_number(t, o->shift_err);
}

/* At the part nearest to a half. */
static void judge(struct table *t, const struct request *r, const selection_outcome *out, int cut) {
    const knob_values *kept = request_list(r, "kept");
    int half = 0;
    for (int i = 1; i < kept->n; i++) {
        half = fabs(kept->v[i] - 0.5) < fabs(kept->v[half] - 0.5) ? i : half;
    }
    const selection_outcome *mean = outcome(r, out, cut, half, 0);
    const selection_outcome *pdf = outcome(r, out, cut, half, 1);
    table_meta(t, "verdict",
               "%s, %.2f of the stamps kept: m changes by %+.1f +- %.1f (mean), %+.1f +- %.1f "
               "(pdf-sym), 10^-3",
               selection_cuts[cut], mean->kept, 1e3 * mean->shift, 1e3 * mean->shift_err,
               1e3 * pdf->shift, 1e3 * pdf->shift_err);
}

static void tabulate(struct table *t, const struct request *r, const selection_outcome *out) {
    const knob_values *kept = request_list(r, "kept");
    const int n = kept->n * SELECTION_ESTIMATORS;
    add_columns(t);
    for (int i = 0; i < N_CUTS * n; i++) {
        add_row(t, i / n, kept->v[i % n / SELECTION_ESTIMATORS], i % SELECTION_ESTIMATORS, &out[i]);
    }
    for (int cut = 0; cut < N_CUTS; cut++) {
        judge(t, r, out, cut);
    }
}

/* ---- figure ---- */

static void draw_panel(shear_figure *f, shear_rect cell, const struct request *r,
                       const selection_outcome *out, int estimator) {
    struct curve curves[N_CUTS] = {{.hue = SHEAR_BLACK, .marker = SHEAR_DISC},
                                   {.hue = SHEAR_BLUE, .marker = SHEAR_SQUARE},
                                   {.hue = SHEAR_SKY, .marker = SHEAR_TRIANGLE},
                                   {.hue = SHEAR_GREEN, .marker = SHEAR_DISC},
                                   {.hue = SHEAR_PURPLE, .marker = SHEAR_CIRCLE},
                                   {.hue = SHEAR_VERMILION, .marker = SHEAR_CROSS}};
    for (int cut = 0; cut < N_CUTS; cut++) {
        curves[cut].label = selection_cuts[cut];
        for (int i = 0; i < request_list(r, "kept")->n; i++) {
            const selection_outcome *o = outcome(r, out, cut, i, estimator);
            curve_add(&curves[cut], o->kept, 1e3 * o->shift, 1e3 * o->shift_err);
        }
    }
    chart_draw(f, &(struct chart){.cell = cell,
                                  .title = selection_estimators[estimator],
                                  .x_label = "part of the stamps that is kept",
                                  .y_label = "m less that without a cut, 10^{-3}",
                                  .legend = SHEAR_TOP_RIGHT,
                                  .truth = 0.0,
                                  .headroom = 0.45,
                                  .spread = 0.008,
                                  .n_curves = N_CUTS,
                                  .curves = curves});
}

int selection_report(const struct request *r, const struct ledger *ledger,
                     const selection_outcome *out, shear_error *err) {
    const shear_grid grid = {.area = {8, 8, 984, 424}, .rows = 1, .columns = 2, .gap_x = 12};
    struct table *t = table_new(r);
    shear_figure *f = NULL;
    tabulate(t, r, out);
    int code = shear_figure_new(&f, 1000, 440, err);
    for (int i = 0; code == SHEAR_OK && i < SELECTION_ESTIMATORS; i++) {
        draw_panel(f, shear_grid_cell(&grid, 0, i, 1, 1), r, out, i);
    }
    code = code != SHEAR_OK ? code : report_save(r, ledger, t, f, err);
    shear_figure_free(f);
    table_free(t);
    return code;
}
