/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiments/narrow.h"

#include "report/chart.h"
#include "report/run.h"

#include <math.h>

/* ---- table ---- */

static void add_columns(struct table *t) {
    static const char *const names[] = {"m1", "m2", "c1", "c2"};
    static const char *const disks[NARROW_DISKS] = {"points", "disks_half", "disks_1", "disks_2"};
    char name[24];
    table_column(t, "r_psf", TABLE_NUMBER, 2, "pix", "R_PSF of eq. (Ws)");
    table_column(t, "settings", TABLE_TEXT, 0, "", "the defaults, or preset zhang2010");
    table_column(t, "beta", TABLE_NUMBER, 2, "pix", "scale radius of the target");
    for (int i = 0; i < 4; i++) {
        table_column(t, names[i], TABLE_NUMBER, i < 2 ? 5 : 6, "",
                     i < 2 ? "multiplicative bias" : "additive bias");
        snprintf(name, sizeof name, "%s_err", names[i]);
        table_column(t, name, TABLE_NUMBER, i < 2 ? 5 : 6, "", "its 1-sigma error");
    }
    table_column(t, "aliases", TABLE_NUMBER, -2, "", "their share, of these galaxies");
    for (int i = 0; i < NARROW_DISKS; i++) {
        table_column(t, disks[i], TABLE_NUMBER, -2, "",
                     i != 0 ? "of exponential disks of this half-light radius, pixels"
                            : "of points");
    }
}

static void add_row(struct table *t, const narrow_point *p, int way) {
    const struct bias *b = &p->bias[way];
    table_number(t, p->r_psf_px);
    table_text(t, narrow_ways[way]);
    table_number(t, p->beta_px[way]);
    for (int c = 0; c < 4; c++) {
        table_number(t, c < 2 ? b->m[c] : b->c[c - 2]);
        table_number(t, c < 2 ? b->m_err[c] : b->c_err[c - 2]);
    }
    table_number(t, way != 0 ? NAN : p->own);
    for (int i = 0; i < NARROW_DISKS; i++) {
        table_number(t, way != 0 ? NAN : p->disk[i]);
    }
}

static void tabulate(struct table *t, const struct narrow *n) {
    add_columns(t);
    for (int way = 0; way < NARROW_WAYS; way++) {
        double worst = 0.0;
        int good = 0;
        int all = 0;
        for (int i = 0; i < n->n; i++) {
            const struct bias *b = &n->points[i].bias[way];
            add_row(t, &n->points[i], way);
            for (int c = 0; c < 2 && n->points[i].r_psf_px > n->limit_px; c++) {
                worst = fmax(worst, fabs(b->m[c]));
                all++;
                good += fabs(b->m[c]) < 2e-3 + 2.0 * b->m_err[c];
            }
        }
        table_meta(t, "verdict",
                   "%s: |m| within 2 10^-3 beside two errors in %d of %d (m1 and m2 of every R_PSF "
                   "above %.2f px), at most %.1f 10^-3",
                   narrow_ways[way], good, all, n->limit_px, 1e3 * worst);
    }
    table_meta(t, "verdict",
               "the aliases of exponential disks of half-light radius 0.5 px are 10^-3 of the "
               "signal at R_PSF = %.2f px",
               n->limit_px);
    table_meta(t, "limit", "%.4f", n->limit_px);
}

/* ---- figure ---- */

enum { CURVES = 2 * NARROW_WAYS };

static void add_biases(struct curve *c, const struct narrow *n, int way, int component) {
    for (int i = 0; i < n->n; i++) {
        const struct bias *b = &n->points[i].bias[way];
        curve_add(c, n->points[i].r_psf_px, 1e3 * b->m[component], 1e3 * b->m_err[component]);
    }
}

static void draw_m(shear_figure *f, shear_rect cell, const struct narrow *n, bool both) {
    struct curve curves[CURVES] = {
        {.label = "defaults, g_{1}", .hue = SHEAR_BLUE, .marker = SHEAR_DISC},
        {.label = "g_{2}", .hue = SHEAR_BLUE, .marker = SHEAR_CIRCLE},
        {.label = "log-bicubic (zhang2010), g_{1}", .hue = SHEAR_VERMILION, .marker = SHEAR_SQUARE},
        {.label = "g_{2}", .hue = SHEAR_VERMILION, .marker = SHEAR_CROSS}};
    for (int i = 0; i < CURVES; i++) {
        add_biases(&curves[i], n, i / 2, i % 2);
    }
    chart_draw(f, &(struct chart){.cell = cell,
                                  .title = both ? "bias" : "the defaults alone",
                                  .x_label = "R_{PSF}, px",
                                  .y_label = "m, 10^{-3}",
                                  .legend = SHEAR_BOTTOM_RIGHT,
                                  .truth = 0.0,
                                  .limit = n->limit_px,
                                  .spread = 0.006,
                                  .n_curves = both ? CURVES : 2,
                                  .curves = curves});
}

static void draw_c(shear_figure *f, shear_rect cell, const struct narrow *n) {
    struct curve curves[NARROW_WAYS] = {
        {.label = "defaults", .hue = SHEAR_BLUE, .marker = SHEAR_DISC},
        {.label = "log-bicubic (zhang2010)", .hue = SHEAR_VERMILION, .marker = SHEAR_SQUARE}};
    for (int i = 0; i < n->n * NARROW_WAYS; i++) {
        const narrow_point *p = &n->points[i / NARROW_WAYS];
        const struct bias *b = &p->bias[i % NARROW_WAYS];
        curve_add(&curves[i % NARROW_WAYS], p->r_psf_px, hypot(b->c[0], b->c[1]),
                  fmax(b->c_err[0], b->c_err[1]));
    }
    chart_draw(f, &(struct chart){.cell = cell,
                                  .title = "additive bias",
                                  .x_label = "R_{PSF}, px",
                                  .y_label = "|c|",
                                  .y = {1e-8, 1e-1},
                                  .log_y = true,
                                  .truth = NAN,
                                  .limit = n->limit_px,
                                  .n_curves = NARROW_WAYS,
                                  .curves = curves});
}

static void draw_aliases(shear_figure *f, shear_rect cell, const struct narrow *n) {
    struct curve curves[NARROW_DISKS + 1] = {
        {.label = "points", .hue = SHEAR_BLACK, .dash = SHEAR_DOTTED},
        {.label = "disks of half-light radius 0.5 px", .hue = SHEAR_VERMILION},
        {.label = "1 px", .hue = SHEAR_GREEN},
        {.label = "2 px", .hue = SHEAR_SKY},
        {.label = "the galaxies measured", .hue = SHEAR_BLUE, .dash = SHEAR_DASHED}};
    for (int i = 0; i <= NARROW_DISKS; i++) {
        curves[i].line = true;
        for (int k = 0; k < n->n; k++) {
            const narrow_point *p = &n->points[k];
            curve_add(&curves[i], p->r_psf_px, i < NARROW_DISKS ? p->disk[i] : p->own, NAN);
        }
    }
    chart_draw(f, &(struct chart){.cell = cell,
                                  .title = "aliases' part of the signal",
                                  .x_label = "R_{PSF}, px",
                                  .y_label = "A(\xce\xb2)",
                                  .y = {1e-8, 1.0},
                                  .log_y = true,
                                  .truth = 1e-3,
                                  .limit = n->limit_px,
                                  .n_curves = NARROW_DISKS + 1,
                                  .curves = curves});
}

int narrow_report(const struct request *r, const struct ledger *ledger, const struct narrow *n,
                  shear_error *err) {
    const shear_grid grid = {
        .area = {8, 8, 1084, 724}, .rows = 2, .columns = 2, .gap_x = 12, .gap_y = 8};
    struct table *t = table_new(r);
    shear_figure *f = NULL;
    tabulate(t, n);
    int code = shear_figure_new(&f, 1100, 740, err);
    if (code == SHEAR_OK) {
        draw_m(f, shear_grid_cell(&grid, 0, 0, 1, 1), n, true);
        draw_m(f, shear_grid_cell(&grid, 0, 1, 1, 1), n, false);
        draw_aliases(f, shear_grid_cell(&grid, 1, 0, 1, 1), n);
        draw_c(f, shear_grid_cell(&grid, 1, 1, 1, 1), n);
        code = report_save(r, ledger, t, f, err);
    }
    shear_figure_free(f);
    table_free(t);
    return code;
}
