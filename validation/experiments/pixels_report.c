/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/must.h"
#include "experiments/pixels.h"

#include "report/chart.h"
#include "report/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int pixels_samplings(const struct request *r) {
    return request_number(r, "coarse") > 0.0 ? N_PSF_SAMPLINGS : 1;
}

/* ---- one point ---- */

struct point {
    double g[2], err[2], pull[2]; /* against the true shear */
    double dev[2], dev_err[2];    /* from the well-sampled reference */
    double twin, twin_err;        /* |dev| of the plain twin minus one's own */
};

/* Which series of a size's tally; `twin` is the one without the logarithm, or the same. */
struct pick {
    int series, twin;
};

/* g1, g2, dev1, dev2, |dev| of the twin minus |dev|. */
static void estimate(const struct total *totals, const void *context, double *out) {
    const struct pick *pick = context;
    const struct total *of[] = {&totals[0], &totals[pick->series], &totals[pick->twin]};
    double g[3][2];
    for (int i = 0; i < 3; i++) {
        g[i][0] = of[i]->n1 / of[i]->d;
        g[i][1] = of[i]->n2 / of[i]->d;
    }
    out[0] = g[1][0];
    out[1] = g[1][1];
    out[2] = g[1][0] - g[0][0];
    out[3] = g[1][1] - g[0][1];
    out[4] = hypot(g[2][0] - g[0][0], g[2][1] - g[0][1]) - hypot(out[2], out[3]);
}

static int point_of(const struct request *r, const struct tally *tally, int ratio, int method,
                    int psf, struct point *p, shear_error *err) {
    enum { N = 5 };
    double v[N];
    double cov[N * N];
    int first = 1 + (ratio * pixels_samplings(r) + psf) * N_METHODS;
    int plain = methods[method].plain;
    const struct pick pick = {first + method, first + (plain >= 0 ? plain : method)};
    const double truth[] = {r->mock.g1, r->mock.g2};
    int code = tally_jackknife(tally, estimate, &pick, N, v, cov, err);
    for (int c = 0; code == SHEAR_OK && c < 2; c++) {
        p->g[c] = v[c];
        p->err[c] = sqrt(cov[c * N + c]);
        p->pull[c] = (v[c] - truth[c]) / p->err[c];
        p->dev[c] = v[2 + c];
        p->dev_err[c] = sqrt(cov[(2 + c) * N + 2 + c]);
    }
    p->twin = plain >= 0 ? v[4] : NAN;
    p->twin_err = plain >= 0 ? sqrt(cov[4 * N + 4]) : NAN;
    return code;
}

/* ---- table and verdicts ---- */

static void add_columns(struct table *t) {
    table_column(t, "size", TABLE_NUMBER, 2, "", "R_G over R_PSF");
    table_column(t, "ratio", TABLE_NUMBER, 2, "", "pixel size over R_PSF");
    table_column(t, "method", TABLE_TEXT, 0, "", "interpolation");
    table_column(t, "psf", TABLE_TEXT, 0, "",
                 "PSF given finely sampled, or interpolated from the same pixels");
    for (int c = 1; c <= 2; c++) {
        char name[24];
        snprintf(name, sizeof name, "g%d", c);
        table_column(t, name, TABLE_NUMBER, 5, "", "measured shear");
        snprintf(name, sizeof name, "g%d_err", c);
        table_column(t, name, TABLE_NUMBER, 5, "", "its 1-sigma error (jackknife)");
        snprintf(name, sizeof name, "pull%d", c);
        table_column(t, name, TABLE_NUMBER, 2, "", "(measured - true) / error");
        snprintf(name, sizeof name, "dev%d", c);
        table_column(t, name, TABLE_NUMBER, 5, "",
                     "measured, minus well sampled, the same galaxies");
        snprintf(name, sizeof name, "dev%d_err", c);
        table_column(t, name, TABLE_NUMBER, 5, "", "its 1-sigma error");
    }
    table_column(t, "gain", TABLE_NUMBER, 5, "", "|deviation| without the logarithm minus with it");
    table_column(t, "gain_err", TABLE_NUMBER, 5, "", "its 1-sigma error");
}

static void add_row(struct table *t, double size, double ratio, int method, int psf,
                    const struct point *p) {
    table_number(t, size);
    table_number(t, ratio);
    table_text(t, methods[method].label);
    table_text(t, psf_sampling_names[psf]);
    for (int c = 0; c < 2; c++) {
        table_number(t, p->g[c]);
        table_number(t, p->err[c]);
        table_number(t, p->pull[c]);
        table_number(t, p->dev[c]);
        table_number(t, p->dev_err[c]);
    }
    table_number(t, p->twin);
    table_number(t, p->twin_err);
}

struct score {
    int best, best_good; /* points of the two best methods up to ratio 2; within 3 errors */
    double worst;        /* the largest pull among them */
    int twins, twins_better, twins_worse; /* by 3 errors */
};

static void score_point(struct score *s, double ratio, int method, const struct point *p) {
    if (method >= N_METHODS - 2 && ratio <= 2.0) {
        for (int c = 0; c < 2; c++) {
            s->best++;
            s->best_good += fabs(p->pull[c]) <= 3.0;
            s->worst = fmax(s->worst, fabs(p->pull[c]));
        }
    }
    if (methods[method].plain >= 0) {
        s->twins++;
        s->twins_better += p->twin > 3.0 * p->twin_err;
        s->twins_worse += p->twin < -3.0 * p->twin_err;
    }
}

static void judge(struct table *t, int psf, const struct score *s) {
    const char *name = psf_sampling_names[psf];
    table_meta(t, "verdict",
               "%s PSF: Log-Bicubic and Log-Spline up to pixel/R_PSF = 2: %d of %d shears within 3 "
               "errors, largest pull %.1f",
               name, s->best_good, s->best, s->worst);
    table_meta(t, "verdict",
               "%s PSF: with the logarithm nearer to the well-sampled shear in %d of %d cases, "
               "farther in %d, alike in %d",
               name, s->twins_better, s->twins, s->twins_worse,
               s->twins - s->twins_better - s->twins_worse);
}

/* ---- figures ---- */

/* curves [psf][size][component][method] */
typedef struct curve curves[PIXELS_MAX_SIZES][2][N_METHODS];

static int draw(const struct request *r, curves all, shear_figure **f, shear_error *err) {
    const knob_values *sizes = request_list(r, "sizes");
    int code = shear_figure_new(f, 980, 250 * sizes->n + 40, err);
    const shear_grid grid = {.area = {8, 8, 964, 250.0 * sizes->n + 24},
                             .rows = sizes->n,
                             .columns = 2,
                             .gap_x = 10,
                             .gap_y = 4};
    for (int i = 0; code == SHEAR_OK && i < 2 * sizes->n; i++) {
        int row = i / 2;
        int c = i % 2;
        char title[48];
        snprintf(title, sizeof title, "R_{G} = %g R_{PSF}", sizes->v[row]);
        chart_draw(*f,
                   &(struct chart){.cell = shear_grid_cell(&grid, row, c, 1, 1),
                                   .title = title,
                                   .x_label = row + 1 == sizes->n ? "pixel size / R_{PSF}" : NULL,
                                   .y_label = c != 0 ? "g_{2}" : "g_{1}",
                                   .legend = SHEAR_TOP_LEFT,
                                   .truth = c != 0 ? r->mock.g2 : r->mock.g1,
                                   .spread = 0.008,
                                   .headroom = i == 0 ? 0.9 : 0.0,
                                   .n_curves = N_METHODS,
                                   .curves = all[row][c]});
    }
    return code;
}

static void add_point(curves all, int size, double ratio, int method, const struct point *p) {
    for (int c = 0; c < 2; c++) {
        struct curve *curve = &all[size][c][method];
        curve->hue = methods[method].hue;
        curve->marker = methods[method].marker;
        curve->label = size == 0 && c == 0 ? methods[method].label : NULL;
        curve_add(curve, ratio, p->g[c], p->err[c]);
    }
}

/* ---- all ---- */

static int fill(const struct request *r, struct tally *const *tallies, int psf, struct table *t,
                curves all, shear_error *err) {
    const knob_values *sizes = request_list(r, "sizes");
    const knob_values *ratios = request_list(r, "ratios");
    struct score score = {0};
    for (int i = 0; i < sizes->n * ratios->n * N_METHODS; i++) {
        int method = i % N_METHODS;
        int k = i / N_METHODS % ratios->n;
        int size = i / N_METHODS / ratios->n;
        struct point p;
        int code = point_of(r, tallies[size], k, method, psf, &p, err);
        if (code != SHEAR_OK) {
            return code;
        }
        add_row(t, sizes->v[size], ratios->v[k], method, psf, &p);
        add_point(all, size, ratios->v[k], method, &p);
        score_point(&score, ratios->v[k], method, &p);
    }
    judge(t, psf, &score);
    return SHEAR_OK;
}

int pixels_report(const struct request *r, const struct ledger *ledger,
                  struct tally *const *tallies, shear_error *err) {
    struct table *t = table_new(r);
    shear_figure *figures[N_PSF_SAMPLINGS] = {0};
    int code = SHEAR_OK;
    curves *all = memory_new(N_PSF_SAMPLINGS, sizeof *all, "curves", &code, err);
    add_columns(t);
    for (int psf = 0; code == SHEAR_OK && psf < pixels_samplings(r); psf++) {
        code = fill(r, tallies, psf, t, all[psf], err);
        code = code != SHEAR_OK ? code : draw(r, all[psf], &figures[psf], err);
    }
    code = code != SHEAR_OK ? code : report_save(r, ledger, t, figures[PSF_FINE], err);
    if (code == SHEAR_OK && figures[PSF_COARSE] != NULL) {
        code = report_picture(r, "coarse", figures[PSF_COARSE], err);
    }
    shear_figure_free(figures[PSF_FINE]);
    shear_figure_free(figures[PSF_COARSE]);
    free(all);
    table_free(t);
    return code;
}
