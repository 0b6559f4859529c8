/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiments/survey.h"

#include "report/chart.h"
#include "report/run.h"

#include <math.h>

/* ---- what is asked for ---- */

static bool wish_is_met(const struct flaw *f, double snr, const trial_outcome *o) {
    switch (f->wish) {
    case WISH_TOLD:
        return o->told > TOLD_NOTHING || (f->wish_snr > 0.0 && snr > f->wish_snr);
    case WISH_FLAGS:
        return o->flagged == o->spoilt;
    case WISH_NO_EDGE:
        return o->edge == 0.0;
    case WISH_QUIET:
        return o->told == TOLD_NOTHING;
    default:
        return true;
    }
}

/* NaN is not small. */
static bool bias_is_small(const struct flaw *f, const trial_outcome *o) {
    return f->aim_m == 0.0 || fabs(o->m) < 1e-3 * f->aim_m + 2.0 * o->m_err;
}

static bool is_met(const struct flaw *f, double snr, const trial_outcome *o) {
    return wish_is_met(f, snr, o) && bias_is_small(f, o);
}

static char *aim_text(const struct flaw *f, char *buf, size_t size) {
    static const char *const wishes[] = {"", "told", "flagged", "no advice for edge", "quiet"};
    char bias[32] = "";
    char to[24] = "";
    if (f->aim_m > 0.0) {
        snprintf(bias, sizeof bias, "m within %g%s", f->aim_m, f->wish != 0 ? ", " : "");
    }
    if (f->wish_snr > 0.0) {
        snprintf(to, sizeof to, " to S/N %g", f->wish_snr);
    }
    snprintf(buf, size, "%s%s%s", bias, wishes[f->wish], to);
    return buf;
}

/* ---- table ---- */

static void add_columns(struct table *t) {
    table_column(t, "case", TABLE_TEXT, 0, "", "what is wrong with the data");
    table_column(t, "label", TABLE_TEXT, 0, "", "the same in words");
    table_column(t, "snr", TABLE_NUMBER, 0, "", "signal-to-noise of the galaxies");
    table_column(t, "estimator", TABLE_TEXT, 0, "", "mean or pdf-sym");
    table_column(t, "m", TABLE_NUMBER, 4, "", "multiplicative bias along the shear");
    table_column(t, "m_err", TABLE_NUMBER, 4, "", "its 1-sigma error");
    for (int c = 1; c <= 2; c++) {
        char name[24];
        snprintf(name, sizeof name, "c%d", c);
        table_column(t, name, TABLE_NUMBER, 5, "", "additive bias");
        snprintf(name, sizeof name, "c%d_err", c);
        table_column(t, name, TABLE_NUMBER, 5, "", "its 1-sigma error");
    }
    table_column(t, "level", TABLE_NUMBER, 4, "",
                 "noise under the galaxies over the noise stamps'");
    table_column(t, "level_err", TABLE_NUMBER, 4, "", "its 1-sigma error");
    table_column(t, "stamps", TABLE_INTEGER, 0, "", "that were measured, of both signs");
    table_column(t, "flagged", TABLE_INTEGER, 0, "", "that were left out");
    table_column(t, "spoilt", TABLE_INTEGER, 0, "", "that should be");
    table_column(t, "told", TABLE_TEXT, 0, "", "refused, no shear, flagged, warned, or no");
    table_column(t, "aim", TABLE_TEXT, 0, "", "m in 10^-3, beside two errors");
    table_column(t, "met", TABLE_TEXT, 0, "", "yes or no");
}

static void add_row(struct table *t, const struct flaw *f, double snr, int way,
                    const trial_outcome *o) {
    char aim[80];
    char told[48];
    table_text(t, f->name);
    table_text(t, f->label);
    table_number(t, snr);
    table_text(t, way != 0 ? "pdf-sym" : "mean");
    table_number(t, o->m);
    table_number(t, o->m_err);
    for (int c = 0; c < 2; c++) {
        table_number(t, o->c[c]);
        table_number(t, o->c_err[c]);
    }
    table_number(t, o->level);
    table_number(t, o->level_err);
    table_number(t, o->used);
    table_number(t, o->flagged);
    table_number(t, o->spoilt);
    table_text(t, trial_told_text(o, told, sizeof told));
    table_text(t, aim_text(f, aim, sizeof aim));
    table_text(t, is_met(f, snr, o) ? "yes" : "no");
}

/* One line for a row of the table of flaws: at which signal-to-noise it is met. */
static void judge(struct table *t, const knob_values *snrs, const struct flaw *f,
                  const trial_outcome *out, int *met) {
    char text[SURVEY_WAYS][160];
    char aim[80];
    char told[48];
    bool all = true;
    const trial_outcome *loudest = &out[0];
    for (int way = 0; way < SURVEY_WAYS; way++) {
        size_t used = 0;
        for (int i = 0; i < snrs->n; i++) {
            const trial_outcome *o = &out[i * SURVEY_WAYS + way];
            const bool good = is_met(f, snrs->v[i], o);
            all = all && good;
            loudest = o->told > loudest->told ? o : loudest;
            used +=
                (size_t)snprintf(text[way] + used, sizeof text[way] - used, "%s%.1f +- %.1f%s",
                                 i != 0 ? ", " : "", 1e3 * o->m, 1e3 * o->m_err, good ? "" : "!");
        }
    }
    *met += all;
    table_meta(t, "verdict", "%s (%s): %s; mean %s; pdf-sym %s; told: %s", f->label,
               aim_text(f, aim, sizeof aim), all ? "met" : "not met", text[0], text[1],
               trial_told_text(loudest, told, sizeof told));
}

static void tabulate(struct table *t, const knob_values *snrs, const struct survey *s) {
    int met = 0;
    add_columns(t);
    for (int row = 0; row < s->n; row++) {
        const struct flaw *f = &flaws[s->rows[row]];
        for (int i = 0; i < s->n_levels * SURVEY_WAYS; i++) {
            add_row(t, f, snrs->v[i / SURVEY_WAYS], i % SURVEY_WAYS, &s->out[row][i]);
        }
    }
    for (int row = 0; row < s->n; row++) {
        judge(t, snrs, &flaws[s->rows[row]], s->out[row], &met);
    }
    table_meta(t, "met", "%d", met);
    table_meta(t, "cases", "%d", s->n);
}

/* ---- figure: m against signal-to-noise, a panel for each row that has an aim for it ---- */

static void draw_panel(shear_figure *f, shear_rect cell, const knob_values *snrs,
                       const struct flaw *flaw, const trial_outcome *out, bool legend) {
    struct curve curves[SURVEY_WAYS] = {
        {.hue = SHEAR_BLUE, .marker = SHEAR_SQUARE, .label = legend ? "mean" : NULL},
        {.hue = SHEAR_VERMILION, .marker = SHEAR_DISC, .label = legend ? "pdf-sym" : NULL}};
    for (int i = 0; i < snrs->n * SURVEY_WAYS; i++) {
        curve_add(&curves[i % SURVEY_WAYS], snrs->v[i / SURVEY_WAYS], 1e3 * out[i].m,
                  1e3 * out[i].m_err);
    }
    chart_draw(f, &(struct chart){.cell = cell,
                                  .title = flaw->label,
                                  .x_label = "S/N",
                                  .y_label = "m, 10^{-3}",
                                  .log_x = true,
                                  .legend = SHEAR_TOP_RIGHT,
                                  .truth = 0.0,
                                  .headroom = legend ? 0.6 : 0.0,
                                  .spread = 0.02,
                                  .n_curves = SURVEY_WAYS,
                                  .curves = curves});
}

static int draw(const struct request *r, const struct survey *s, shear_figure **figure,
                shear_error *err) {
    enum { COLUMNS = 3 };
    int panels[SURVEY_MAX_ROWS];
    int n = 0;
    for (int row = 0; row < s->n; row++) {
        if (flaws[s->rows[row]].aim_m > 0.0) {
            panels[n++] = row;
        }
    }
    const int lines = n > 0 ? (n + COLUMNS - 1) / COLUMNS : 1;
    const shear_grid grid = {.area = {8, 8, 1084, 220.0 * lines},
                             .rows = lines,
                             .columns = COLUMNS,
                             .gap_x = 10,
                             .gap_y = 6};
    const int code = shear_figure_new(figure, 1100, 220 * lines + 16, err);
    for (int i = 0; code == SHEAR_OK && i < n; i++) {
        draw_panel(*figure, shear_grid_cell(&grid, i / COLUMNS, i % COLUMNS, 1, 1),
                   request_list(r, "snrs"), &flaws[s->rows[panels[i]]], s->out[panels[i]], i == 0);
    }
    return code;
}

int survey_report(const struct request *r, const struct ledger *ledger, const struct survey *s,
                  shear_error *err) {
    struct table *t = table_new(r);
    shear_figure *f = NULL;
    tabulate(t, request_list(r, "snrs"), s);
    int code = draw(r, s, &f, err);
    code = code != SHEAR_OK ? code : report_save(r, ledger, t, f, err);
    shear_figure_free(f);
    table_free(t);
    return code;
}
