/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiments/bias_report.h"

#include <math.h>

/* the project's goal for shears up to 0.02 */
static const double m_goal = 1e-3;
static const double c_goal = 1e-5;

const char *const bias_kinds[] = {"regular", "irregular"};
const char *const bias_psfs[] = {"A", "B"};
const char *const bias_noises[] = {"none", "white", "sources"};
static const char *const ways[] = {"none", "Log-Bicubic", "Log-Spline"};

/* ---- table ---- */

static const column columns[] = {
    {"galaxy", TABLE_TEXT, 0, .help = "kind of the galaxies"},
    {"psf", TABLE_TEXT, 0, .help = "form of the PSF"},
    {"method", TABLE_TEXT, 0, .help = "interpolation"},
    {"noise", TABLE_TEXT, 0, .help = "kind of noise"},
    {"shears", TABLE_TEXT, 0, .help = "small (m and c) or large (m and the cubic term)"},
    {"n", TABLE_INTEGER, 0, .help = "stamps at each shear, rotated copies included"},
    {"m#", TABLE_NUMBER, 6,
     .help = "multiplicative bias (of both components where shears are large)", .with_error = true},
    {"c#", TABLE_NUMBER, 7, .help = "additive bias", .with_error = true},
    {"worst_pull", TABLE_NUMBER, 1, .help = "largest of |m|/error and |c|/error"},
    {"cubic", TABLE_NUMBER, 3, .help = "a in measured - true = m g + a |g|^2 g",
     .with_error = true},
    {0}};

static double worst_pull(const bias_fit *b) {
    double worst = 0.0;
    for (int c = 0; c < 2; c++)
        worst = fmax(worst, fmax(fabs(b->m[c] / b->m_err[c]), fabs(b->c[c] / b->c_err[c])));
    return worst;
}

static void add_row(table *t, const line *l) {
    const bias_fit *b = &l->bias;
    table_texts(t, bias_kinds[l->of.kind], bias_psfs[l->of.psf], ways[l->way],
                bias_noises[l->of.noise], l->of.large ? "large" : "small");
    table_numbers(t, l->n);
    if (l->of.large) {
        table_numbers(t, l->cubic.m, l->cubic.m_err, NAN, NAN, NAN, NAN, NAN, NAN);
        table_numbers(t, NAN, l->cubic.cubic, l->cubic.cubic_err);
        return;
    }
    for (int c = 0; c < 2; c++)
        table_numbers(t, b->m[c], b->m_err[c], b->c[c], b->c_err[c]);
    table_numbers(t, worst_pull(b), NAN, NAN);
}

/* For m or c: the number of components, of those below the goal, of those whose error is below it,
 * and the largest one. */
typedef struct score {
    int n, good, sure;
    double worst;
} score;

static void score_value(score *s, double value, double err, double goal) {
    s->n++;
    s->good += fabs(value) < goal;
    s->sure += err < goal;
    s->worst = fmax(s->worst, fabs(value));
}

static void conclude_noise(table *t, const lines *all, enum bias_noise noise, bool interpolated) {
    score m = {0};
    score c = {0};
    for (int i = 0; i < 2 * all->n; i++) {
        const line *l = &all->of[i / 2];
        if (!l->of.large && l->of.noise == noise && l->of.interpolated == interpolated) {
            score_value(&m, l->bias.m[i % 2], l->bias.m_err[i % 2], m_goal);
            score_value(&c, l->bias.c[i % 2], l->bias.c_err[i % 2], c_goal);
        }
    }
    if (m.n > 0) {
        table_meta(t, TABLE_CONCLUSION,
                   "%s, noise %s: |m| < %g in %d of %d (errors below that: %d), largest %.2g; "
                   "|c| < %g in %d (errors below that: %d), largest %.2g",
                   interpolated ? "interpolated" : "not interpolated", bias_noises[noise], m_goal,
                   m.good, m.n, m.sure, m.worst, c_goal, c.good, c.sure, c.worst);
    }
}

static void tabulate(table *t, const lines *all) {
    table_columns(t, columns);
    for (int i = 0; i < all->n; i++)
        add_row(t, &all->of[i]);
    for (int i = 0; i < 6; i++)
        conclude_noise(t, all, (enum bias_noise)(i % 3), i / 3 == 1);
    for (int i = 0; i < all->n; i++) {
        const line *l = &all->of[i];
        if (l->of.large) {
            table_meta(t, TABLE_CONCLUSION, "%s, W_%s: next order a = %.3f +- %.3f",
                       bias_kinds[l->of.kind], bias_psfs[l->of.psf], l->cubic.cubic,
                       l->cubic.cubic_err);
        }
    }
}

/* ---- figure ---- */

/* The rows of small shears as points, one above the other, with their names on the left. */
typedef struct points {
    int n;
    char text[MAX_LINES][64];
    const char *names[MAX_LINES];
    double x[2][MAX_LINES], y[2][MAX_LINES], err[2][MAX_LINES]; /* by component */
} points;

static void add_point(points *p, const line *l, bool of_c) {
    const bias_fit *b = &l->bias;
    snprintf(p->text[p->n], sizeof p->text[0], "%s W_{%s}, %s, noise %s", bias_kinds[l->of.kind],
             bias_psfs[l->of.psf], ways[l->way], bias_noises[l->of.noise]);
    p->names[p->n] = p->text[p->n];
    for (int c = 0; c < 2; c++) {
        p->x[c][p->n] = of_c ? b->c[c] : b->m[c];
        p->err[c][p->n] = of_c ? b->c_err[c] : b->m_err[c];
        p->y[c][p->n] = p->n + (c != 0 ? -0.14 : 0.14);
    }
    p->n++;
}

static shear_range range_of(const points *p, double goal) {
    shear_range range = {-1.5 * goal, 1.5 * goal};
    for (int k = 0; k < 2 * p->n; k++) {
        const double at = p->x[k % 2][k / 2];
        const double e = p->err[k % 2][k / 2];
        range = shear_range_join(range, (shear_range){at - e, at + e});
    }
    return shear_range_pad(range, 0.05);
}

/* Draw m or c; the goal is a band. */
static void draw_bias(shear_figure *f, shear_rect cell, const lines *all, bool of_c) {
    static points p;
    const double goal = of_c ? c_goal : m_goal;
    p.n = 0;
    for (int i = 0; i < all->n; i++) {
        if (!all->of[i].of.large)
            add_point(&p, &all->of[i], of_c);
    }
    shear_axes_begin(
        f, &(shear_axes){
               cell, of_c ? "additive bias" : "multiplicative bias",
               .x = {range_of(&p, goal), .label = of_c ? "c" : "m"},
               .y = {{-0.8, p.n - 0.2}, .n_names = of_c ? 0 : p.n, .names = p.names, .bare = of_c},
               .legend = SHEAR_BOTTOM_RIGHT});
    shear_axes_vband(f, -goal, goal, &(shear_style){.colour = shear_palette(SHEAR_GREY)});
    shear_axes_vline(f, 0.0, &(shear_style){.dash = SHEAR_DOTTED});
    for (int c = 0; c < 2; c++) {
        const char *label = c != 0 ? "g_{2}" : "g_{1}";
        shear_axes_points(f, (size_t)p.n, p.x[c], p.y[c], p.err[c], NULL,
                          &(shear_style){shear_palette(c != 0 ? SHEAR_BLUE : SHEAR_VERMILION),
                                         .size = 5.0, .label = of_c ? NULL : label});
    }
    shear_axes_end(f);
}

static void draw(run *r, const lines *all) {
    static const double widths[] = {0.62, 0.38};
    int n = 0;
    for (int i = 0; i < all->n; i++)
        n += !all->of[i].of.large;
    const double height = 24.0 * n + 90.0;
    const double more = all->n_large > 0 ? 300.0 : 0.0;
    const shear_grid grid = {{8, 8, 984, height}, 1, 2, .gap_x = 8, .column_weights = widths};
    shear_figure *f = run_figure(r, NULL, 1000, (int)(height + more) + 16);
    draw_bias(f, shear_grid_cell(&grid, 0, 0, 1, 1), all, false);
    draw_bias(f, shear_grid_cell(&grid, 0, 1, 1, 1), all, true);
    if (all->n_large > 0) {
        chart_draw(f, (shear_rect){200, height + 8, 600, more},
                   &(chart){"higher orders, without noise", "|g|", "(measured - g) / g",
                            .legend = SHEAR_BOTTOM_RIGHT, .truth = 0.0, .spread = 0.012,
                            .n_curves = all->n_large, .curves = all->large});
    }
}

void bias_report(run *r, const lines *all) {
    tabulate(r->table, all);
    draw(r, all);
}
