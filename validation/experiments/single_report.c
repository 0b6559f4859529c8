/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiments/single.h"
#include "report/run.h"

#include <math.h>

enum { BINS = 60 };

/* ---- table ---- */

/* Squared distance from the truth at one position. */
static double square_of(const struct object *o, int ratio, int series, int64_t k) {
    const struct shears *s = &o->at[ratio];
    double d1 = s->g[0][series * s->n + k] - o->truth[0];
    double d2 = s->g[1][series * s->n + k] - o->truth[1];
    return d1 * d1 + d2 * d2;
}

/* Root mean square distance of a component from the truth. */
static double rms_of(const struct object *o, int ratio, int series) {
    double sum = 0.0;
    for (int64_t k = 0; k < o->at[ratio].n; k++) {
        sum += square_of(o, ratio, series, k);
    }
    return sqrt(sum / (2.0 * (double)o->at[ratio].n));
}

static double rms_of_all(const struct object *objects, int n, int ratio, int series) {
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        double rms = rms_of(&objects[i], ratio, series);
        sum += rms * rms / n;
    }
    return sqrt(sum);
}

/* +1 where series `a` is nearer to the truth than `b` by 3 errors of their difference at the same
 * positions, -1 where it is farther, 0 where they are alike. */
static int nearer(const struct object *o, int ratio, int a, int b) {
    double n = (double)o->at[ratio].n;
    double sum = 0.0;
    double square = 0.0;
    for (int64_t k = 0; k < o->at[ratio].n; k++) {
        double d = square_of(o, ratio, b, k) - square_of(o, ratio, a, k);
        sum += d;
        square += d * d;
    }
    double err = sqrt(fmax(square - sum * sum / n, 0.0));
    return sum > 3.0 * err ? 1 : sum < -3.0 * err ? -1 : 0;
}

static void add_columns(struct table *t) {
    table_column(t, "ratio", TABLE_NUMBER, 2, "", "pixel size over R_PSF");
    table_column(t, "method", TABLE_TEXT, 0, "", "interpolation");
    table_column(t, "psf", TABLE_TEXT, 0, "",
                 "PSF given finely sampled, or interpolated from the same pixels");
    for (int c = 1; c <= 2; c++) {
        char name[24];
        snprintf(name, sizeof name, "bias%d", c);
        table_column(t, name, TABLE_NUMBER, 5, "",
                     "mean over positions, minus the well-sampled shear");
        snprintf(name, sizeof name, "bias%d_err", c);
        table_column(t, name, TABLE_NUMBER, 5, "", "its 1-sigma error");
        snprintf(name, sizeof name, "pull%d", c);
        table_column(t, name, TABLE_NUMBER, 1, "", "bias / error");
        snprintf(name, sizeof name, "scatter%d", c);
        table_column(t, name, TABLE_NUMBER, 5, "", "standard deviation over positions");
    }
    table_column(t, "rms", TABLE_NUMBER, 5, "", "root mean square deviation of a component");
    table_column(t, "rms_all", TABLE_NUMBER, 5, "", "the same over all objects");
    table_column(t, "nearer", TABLE_INTEGER, 0, "",
                 "objects for which it is nearer to the truth than without the logarithm");
    table_column(t, "farther", TABLE_INTEGER, 0, "", "objects for which it is farther from it");
}

/* How many objects say that a series is nearer, and farther, than its plain twin; none for a plain
 * one. */
static void count(const struct object *objects, int n, int ratio, int series, int *near, int *far) {
    int plain = methods[series % N_METHODS].plain;
    *near = *far = 0;
    for (int i = 0; plain >= 0 && i < n; i++) {
        int sign = nearer(&objects[i], ratio, series, series / N_METHODS * N_METHODS + plain);
        *near += sign > 0;
        *far += sign < 0;
    }
}

static void add_rows(struct table *t, const struct request *r, const struct object *objects,
                     int k) {
    int n = (int)request_number(r, "objects");
    const struct shears *s = &objects[0].at[k];
    for (int i = 0; i < N_SERIES; i++) {
        int wins = 0;
        int losses = 0;
        count(objects, n, k, i, &wins, &losses);
        table_number(t, request_list(r, "ratios")->v[k]);
        table_text(t, methods[i % N_METHODS].label);
        table_text(t, psf_sampling_names[i / N_METHODS]);
        for (int c = 0; c < 2; c++) {
            struct spread spread = spread_of(s->g[c] + i * s->n, (size_t)s->n);
            double bias = spread.mean - objects[0].truth[c];
            table_number(t, bias);
            table_number(t, spread.mean_err);
            table_number(t, bias / spread.mean_err);
            table_number(t, spread.width);
        }
        table_number(t, rms_of(&objects[0], k, i));
        table_number(t, rms_of_all(objects, n, k, i));
        table_number(t, methods[i % N_METHODS].plain >= 0 ? (double)wins : NAN);
        table_number(t, methods[i % N_METHODS].plain >= 0 ? (double)losses : NAN);
    }
}

/* Over all objects: in how many of the cases is the logarithm's root mean square smaller? */
static void judge_all(struct table *t, const struct request *r, const struct object *objects) {
    int n = (int)request_number(r, "objects");
    int ratios = request_list(r, "ratios")->n;
    for (int psf = 0; psf < N_PSF_SAMPLINGS; psf++) {
        int better = 0;
        for (int k = 0; k < ratios; k++) {
            for (int i = 0; i < N_METHODS; i++) {
                int plain = methods[i].plain;
                better += plain >= 0 && rms_of_all(objects, n, k, psf * N_METHODS + i) <
                                            rms_of_all(objects, n, k, psf * N_METHODS + plain);
            }
        }
        table_meta(
            t, "verdict",
            "%s PSF: over %d galaxies the logarithm is nearer to the truth in %d of %d cases",
            psf_sampling_names[psf], n, better, ratios * N_METHODS / 2);
    }
}

static void judge(struct table *t, const struct request *r, const struct object *objects) {
    int n = (int)request_number(r, "objects");
    int ratios = request_list(r, "ratios")->n;
    for (int i = 0; i < N_SERIES; i++) {
        int wins = 0;
        int losses = 0;
        for (int k = 0; k < ratios; k++) {
            int near = 0;
            int far = 0;
            count(objects, n, k, i, &near, &far);
            wins += near;
            losses += far;
        }
        if (methods[i % N_METHODS].plain >= 0) {
            table_meta(t, "count",
                       "%s PSF: %s is nearer to the truth than %s in %d of %d cases, farther in %d",
                       psf_sampling_names[i / N_METHODS], methods[i % N_METHODS].label,
                       methods[methods[i % N_METHODS].plain].label, wins, n * ratios, losses);
        }
    }
}

/* ---- figures ---- */

/* The widest histogram of the log methods fits; what lies beyond is cut off. */
static int choose_range(const struct request *r, const struct object *o, int c, shear_range *range,
                        shear_error *err) {
    const struct shears *s = o->at;
    double truth = o->truth[c];
    double reach = 1e-4;
    for (int k = 0; k < request_list(r, "ratios")->n; k++) {
        for (int i = 0; i < N_METHODS; i++) {
            shear_range part;
            int code =
                shear_range_percentile(&part, s[k].g[c] + i * s[k].n, (size_t)s[k].n, 5, 95, err);
            if (code != SHEAR_OK) {
                return code;
            }
            reach =
                methods[i].plain >= 0 ? fmax(reach, fmax(truth - part.lo, part.hi - truth)) : reach;
        }
    }
    *range = (shear_range){truth - 1.5 * reach, truth + 1.5 * reach};
    return SHEAR_OK;
}

static void draw_panel(const struct request *r, shear_figure *f, shear_rect cell,
                       const struct object *o, int series, int c, shear_range range) {
    /* The paper's: purple, blue, red, black. */
    static const int hues[] = {SHEAR_PURPLE, SHEAR_BLUE, SHEAR_VERMILION, SHEAR_BLACK};
    const knob_values *ratios = request_list(r, "ratios");
    const shear_axes axes = {.cell = cell,
                             .title = methods[series % N_METHODS].label,
                             .x = {.range = range, .label = c != 0 ? "g_{2}" : "g_{1}"},
                             .y = {.range = {0.0, 1.12}},
                             .legend = SHEAR_TOP_LEFT};
    shear_axes_begin(f, &axes);
    shear_axes_vline(f, o->truth[c], &(shear_style){.dash = SHEAR_DOTTED, .width = 1.2});
    for (int k = 0; k < ratios->n; k++) {
        const struct shears *s = &o->at[k];
        double counts[BINS];
        char label[32];
        shear_histogram(counts, BINS, range, s->g[c] + series * s->n, (size_t)s->n);
        double top = fmax(shear_range_of(counts, BINS).hi, 1.0);
        for (int b = 0; b < BINS; b++) {
            counts[b] /= top;
        }
        snprintf(label, sizeof label, "%g", ratios->v[k]);
        shear_axes_histogram(f, BINS, range, counts,
                             &(shear_style){.colour = shear_palette(hues[k]),
                                            .width = 1.3,
                                            .label = series % N_METHODS ? NULL : label});
    }
    shear_axes_end(f);
}

static int draw(const struct request *r, const struct object *o, int psf, int c, shear_figure **f,
                shear_error *err) {
    shear_range range;
    int code = choose_range(r, o, c, &range, err);
    code = code != SHEAR_OK ? code : shear_figure_new(f, 900, 560, err);
    const shear_grid grid = {
        .area = {8, 8, 884, 544}, .rows = 2, .columns = 3, .gap_x = 8, .gap_y = 6};
    for (int i = 0; code == SHEAR_OK && i < N_METHODS; i++) {
        draw_panel(r, *f, shear_grid_cell(&grid, i / 3, i % 3, 1, 1), o, psf * N_METHODS + i, c,
                   range);
    }
    return code;
}

static int draw_more(const struct request *r, const struct object *o, shear_error *err) {
    static const struct {
        const char *suffix;
        int psf, c;
    } more[] = {{"g2", PSF_FINE, 1}, {"coarse", PSF_COARSE, 0}};
    int code = SHEAR_OK;
    for (int i = 0; code == SHEAR_OK && i < 2; i++) {
        shear_figure *f = NULL;
        code = draw(r, o, more[i].psf, more[i].c, &f, err);
        code = code != SHEAR_OK ? code : report_picture(r, more[i].suffix, f, err);
        shear_figure_free(f);
    }
    return code;
}

int single_report(const struct request *r, const struct ledger *ledger,
                  const struct object *objects, shear_error *err) {
    struct table *t = table_new(r);
    shear_figure *f = NULL;
    add_columns(t);
    table_meta(t, "well_sampled", "%.6f, %.6f", objects[0].truth[0], objects[0].truth[1]);
    for (int k = 0; k < request_list(r, "ratios")->n; k++) {
        add_rows(t, r, objects, k);
    }
    judge(t, r, objects);
    judge_all(t, r, objects);
    int code = draw(r, objects, PSF_FINE, 0, &f, err);
    code = code != SHEAR_OK ? code : report_save(r, ledger, t, f, err);
    code = code != SHEAR_OK ? code : draw_more(r, objects, err);
    shear_figure_free(f);
    table_free(t);
    return code;
}
