/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiments/bias_report.h"
#include "engine/must.h"

#include "report/chart.h"
#include "report/run.h"

#include <math.h>
#include <stdlib.h>

static const char *const kinds[] = {"regular", "irregular"};
static const char *const psfs[] = {"A", "B"};
static const char *const noises[] = {"none", "white", "sources"};
static const char *const ways[] = {"none", "Log-Bicubic", "Log-Spline"};

/* What the project promises, for shears up to 0.02. */
static const double m_goal = 1e-3;
static const double c_goal = 1e-5;

char *bias_case_name(const bias_case *b, char *buf, size_t size) {
    snprintf(buf, size, "%s,W_%s,noise=%s%s%s", kinds[b->kind], psfs[b->psf], noises[b->noise],
             b->way > 0 ? ",log" : "", b->large ? ",large" : "");
    return buf;
}

/* A line of the table. */
struct line {
    const bias_case *of;
    int method; /* index of ways */
    double n;
    struct bias bias;
    nonlinear cubic; /* of large shears */
};

enum { MAX_LINES = 2 * BIAS_MAX_CASES, MAX_LARGE = 8 };

struct lines {
    int n;
    struct line line[MAX_LINES];
    int n_large; /* relative deviation against |g|, by kind and PSF */
    struct curve large[MAX_LARGE];
    char large_label[MAX_LARGE][64];
};

/* ---- table ---- */

static void add_columns(struct table *t) {
    table_column(t, "galaxy", TABLE_TEXT, 0, "", "kind of the galaxies");
    table_column(t, "psf", TABLE_TEXT, 0, "", "form of the PSF");
    table_column(t, "method", TABLE_TEXT, 0, "", "interpolation");
    table_column(t, "noise", TABLE_TEXT, 0, "", "kind of noise");
    table_column(t, "shears", TABLE_TEXT, 0, "", "small (m and c) or large (m and the cubic term)");
    table_column(t, "n", TABLE_INTEGER, 0, "", "stamps at each shear, rotated copies included");
    for (int c = 1; c <= 2; c++) {
        char name[24];
        snprintf(name, sizeof name, "m%d", c);
        table_column(t, name, TABLE_NUMBER, 6, "",
                     "multiplicative bias (of both components where shears are large)");
        snprintf(name, sizeof name, "m%d_err", c);
        table_column(t, name, TABLE_NUMBER, 6, "", "its 1-sigma error");
        snprintf(name, sizeof name, "c%d", c);
        table_column(t, name, TABLE_NUMBER, 7, "", "additive bias");
        snprintf(name, sizeof name, "c%d_err", c);
        table_column(t, name, TABLE_NUMBER, 7, "", "its 1-sigma error");
    }
    table_column(t, "worst_pull", TABLE_NUMBER, 1, "", "largest of |m|/error and |c|/error");
    table_column(t, "cubic", TABLE_NUMBER, 3, "", "a in measured - true = m g + a |g|^2 g");
    table_column(t, "cubic_err", TABLE_NUMBER, 3, "", "its 1-sigma error");
}

static double worst_pull(const struct bias *b) {
    double worst = 0.0;
    for (int c = 0; c < 2; c++) {
        worst = fmax(worst, fmax(fabs(b->m[c] / b->m_err[c]), fabs(b->c[c] / b->c_err[c])));
    }
    return worst;
}

static void add_row(struct table *t, const struct line *line) {
    const bias_case *b = line->of;
    table_text(t, kinds[b->kind]);
    table_text(t, psfs[b->psf]);
    table_text(t, ways[line->method]);
    table_text(t, noises[b->noise]);
    table_text(t, b->large ? "large" : "small");
    table_number(t, line->n);
    for (int c = 0; c < 2; c++) {
        table_number(t, b->large ? (c != 0 ? NAN : line->cubic.m) : line->bias.m[c]);
        table_number(t, b->large ? (c != 0 ? NAN : line->cubic.m_err) : line->bias.m_err[c]);
        table_number(t, b->large ? NAN : line->bias.c[c]);
        table_number(t, b->large ? NAN : line->bias.c_err[c]);
    }
    table_number(t, b->large ? NAN : worst_pull(&line->bias));
    table_number(t, b->large ? line->cubic.cubic : NAN);
    table_number(t, b->large ? line->cubic.cubic_err : NAN);
}

/* ---- verdicts ---- */

struct score {
    int n, m_good, m_sure, c_good, c_sure; /* components; `sure`: the error is below the goal too */
    double worst_m, worst_c;
};

static void score_line(struct score *s, const struct bias *b) {
    for (int c = 0; c < 2; c++) {
        s->n++;
        s->m_good += fabs(b->m[c]) < m_goal;
        s->m_sure += b->m_err[c] < m_goal;
        s->c_good += fabs(b->c[c]) < c_goal;
        s->c_sure += b->c_err[c] < c_goal;
        s->worst_m = fmax(s->worst_m, fabs(b->m[c]));
        s->worst_c = fmax(s->worst_c, fabs(b->c[c]));
    }
}

static void judge_noise(struct table *t, const struct lines *lines, int noise, bool interpolated) {
    struct score s = {0};
    for (int i = 0; i < lines->n; i++) {
        const struct line *line = &lines->line[i];
        if (!line->of->large && line->of->noise == noise && (line->of->way > 0) == interpolated) {
            score_line(&s, &line->bias);
        }
    }
    if (s.n > 0) {
        table_meta(t, "verdict",
                   "%s, noise %s: |m| < %g in %d of %d (errors below that: %d), largest %.2g; "
                   "|c| < %g in %d (errors below that: %d), largest %.2g",
                   interpolated ? "interpolated" : "not interpolated", noises[noise], m_goal,
                   s.m_good, s.n, s.m_sure, s.worst_m, c_goal, s.c_good, s.c_sure, s.worst_c);
    }
}

static void judge(struct table *t, const struct lines *lines) {
    for (int way = 0; way < 2; way++) {
        for (int noise = 0; noise < 3; noise++) {
            judge_noise(t, lines, noise, way == 1);
        }
    }
    for (int i = 0; i < lines->n; i++) {
        const struct line *line = &lines->line[i];
        if (line->of->large) {
            table_meta(t, "verdict", "%s, W_%s: next order a = %.3f +- %.3f", kinds[line->of->kind],
                       psfs[line->of->psf], line->cubic.cubic, line->cubic.cubic_err);
        }
    }
}

/* ---- figure ---- */

/* One point a line, its name at the left; the goal as a band. */
static void draw_bias(shear_figure *f, shear_rect cell, const struct lines *lines, bool of_c) {
    static char text[MAX_LINES][64];
    const char *names[MAX_LINES];
    double x[2][MAX_LINES], y[2][MAX_LINES], err[2][MAX_LINES];
    int n = 0;
    for (int i = 0; i < lines->n; i++) {
        const struct line *line = &lines->line[i];
        if (line->of->large) {
            continue;
        }
        snprintf(text[n], sizeof text[n], "%s W_{%s}, %s, noise %s", kinds[line->of->kind],
                 psfs[line->of->psf], ways[line->method], noises[line->of->noise]);
        names[n] = text[n];
        for (int c = 0; c < 2; c++) {
            x[c][n] = of_c ? line->bias.c[c] : line->bias.m[c];
            err[c][n] = of_c ? line->bias.c_err[c] : line->bias.m_err[c];
            y[c][n] = n + (c != 0 ? -0.14 : 0.14);
        }
        n++;
    }
    double goal = of_c ? c_goal : m_goal;
    shear_range range = {-1.5 * goal, 1.5 * goal};
    for (int k = 0; k < 2 * n; k++) {
        double at = x[k % 2][k / 2];
        double e = err[k % 2][k / 2];
        range = shear_range_join(range, (shear_range){at - e, at + e});
    }
    const shear_axes axes = {
        .cell = cell,
        .title = of_c ? "additive bias" : "multiplicative bias",
        .x = {.range = shear_range_pad(range, 0.05), .label = of_c ? "c" : "m"},
        .y = {.range = {-0.8, n - 0.2}, .n_names = of_c ? 0 : n, .names = names, .bare = of_c},
        .legend = SHEAR_BOTTOM_RIGHT};
    shear_axes_begin(f, &axes);
    shear_axes_vband(f, -goal, goal, &(shear_style){.colour = shear_palette(SHEAR_GREY)});
    shear_axes_vline(f, 0.0, &(shear_style){.dash = SHEAR_DOTTED});
    for (int c = 0; c < 2; c++) {
        shear_axes_points(
            f, (size_t)n, x[c], y[c], err[c], NULL,
            &(shear_style){.colour = shear_palette(c != 0 ? SHEAR_BLUE : SHEAR_VERMILION),
                           .size = 5.0,
                           .label = of_c     ? NULL
                                    : c != 0 ? "g_{2}"
                                             : "g_{1}"});
    }
    shear_axes_end(f);
}

static void draw_large(shear_figure *f, shear_rect cell, const struct lines *lines) {
    chart_draw(f, &(struct chart){.cell = cell,
                                  .title = "higher orders, without noise",
                                  .x_label = "|g|",
                                  .y_label = "(measured - g) / g",
                                  .legend = SHEAR_BOTTOM_RIGHT,
                                  .truth = 0.0,
                                  .spread = 0.012,
                                  .n_curves = lines->n_large,
                                  .curves = lines->large});
}

static int draw(const struct lines *lines, shear_figure **f, shear_error *err) {
    int n = 0;
    for (int i = 0; i < lines->n; i++) {
        n += !lines->line[i].of->large;
    }
    double height = 24.0 * n + 90.0;
    double more = lines->n_large > 0 ? 300.0 : 0.0;
    int code = shear_figure_new(f, 1000, (int)(height + more) + 16, err);
    static const double widths[] = {0.62, 0.38};
    const shear_grid grid = {
        .area = {8, 8, 984, height}, .rows = 1, .columns = 2, .gap_x = 8, .column_weights = widths};
    if (code == SHEAR_OK) {
        draw_bias(*f, shear_grid_cell(&grid, 0, 0, 1, 1), lines, false);
        draw_bias(*f, shear_grid_cell(&grid, 0, 1, 1, 1), lines, true);
        if (lines->n_large > 0) {
            draw_large(*f, (shear_rect){200, height + 8, 600, more}, lines);
        }
    }
    return code;
}

/* ---- all ---- */

/* Half the difference between +g and -g, over g: what is odd in the shear. Both axes are averaged.
 */
static void relative(const struct total *totals, const void *context, double *out) {
    const shear_set *set = context;
    for (int k = 0; k < set->n / 4; k++) {
        const struct total *along1 = &totals[set->series[4 * k]];
        const struct total *along2 = &totals[set->series[4 * k + 2]];
        double g = set->g[4 * k][0];
        double g1 = 0.5 * (along1[0].n1 / along1[0].d - along1[1].n1 / along1[1].d);
        double g2 = 0.5 * (along2[0].n2 / along2[0].d - along2[1].n2 / along2[1].d);
        out[k] = 0.5 * (g1 + g2) / g - 1.0;
    }
}

static int take_large(const struct tally *tally, const shear_set *set, struct lines *lines,
                      struct line *line, shear_error *err) {
    enum { MOST = BIAS_MAX_SHEARS / 4 };
    double v[MOST];
    double cov[MOST * MOST];
    int n = set->n / 4;
    int code = bias_fit_cubic(tally, set, &line->cubic, err);
    code = code != SHEAR_OK ? code : tally_jackknife(tally, relative, set, n, v, cov, err);
    if (code == SHEAR_OK && lines->n_large < MAX_LARGE) {
        struct curve *curve = &lines->large[lines->n_large];
        *curve = (struct curve){.hue = 1 + lines->n_large, .marker = lines->n_large % 4};
        for (int k = 0; k < n; k++) {
            curve_add(curve, set->g[4 * k][0], v[k], sqrt(cov[k * n + k]));
        }
        char *label = lines->large_label[lines->n_large++];
        snprintf(label, sizeof lines->large_label[0], "%s W_{%s}", kinds[line->of->kind],
                 psfs[line->of->psf]);
        curve->label = label;
    }
    return code;
}

static int take_case(const struct request *r, struct ledger *ledger, const bias_case *b,
                     struct table *t, struct lines *lines, shear_error *err) {
    struct tally *tally = NULL;
    int code = bias_measure(r, ledger, b, &tally, err);
    for (int k = 0; code == SHEAR_OK && k < (b->way > 0 ? 2 : 1); k++) {
        struct line *line = &lines->line[lines->n];
        const shear_set set = bias_shears(r, b, k);
        *line = (struct line){.of = b, .method = b->way > 0 ? 1 + k : 0};
        for (int group = 0; group < tally->groups; group++) {
            line->n += (double)tally_at(tally, set.series[0], group)->n_used;
        }
        code = b->large ? take_large(tally, &set, lines, line, err)
                        : bias_fit(tally, &set, &line->bias, err);
        if (code == SHEAR_OK) {
            add_row(t, line);
            lines->n++;
        }
    }
    tally_free(tally);
    return code;
}

int bias_report(const struct request *r, struct ledger *ledger, const bias_case *cases, int n,
                shear_error *err) {
    struct table *t = table_new(r);
    shear_figure *f = NULL;
    int code = SHEAR_OK;
    struct lines *lines = memory_new(1, sizeof *lines, "results", &code, err);
    add_columns(t);
    for (int i = 0; code == SHEAR_OK && i < n; i++) {
        code = take_case(r, ledger, &cases[i], t, lines, err);
    }
    if (code == SHEAR_OK) {
        judge(t, lines);
        code = draw(lines, &f, err);
    }
    code = code != SHEAR_OK ? code : report_save(r, ledger, t, f, err);
    shear_figure_free(f);
    free(lines);
    table_free(t);
    return code;
}
