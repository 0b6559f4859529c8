/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Section 4.4: noise and pixels at once; both kinds of galaxies under both PSFs, four sizes. */
#include "engine/experiment.h"
#include "engine/methods.h"
#include "engine/must.h"
#include "report/chart.h"
#include "report/run.h"

#include <math.h>
#include <stdlib.h>

enum { N_PANELS = 4, N_BEST = 2, MAX_SIZES = 8 };

static const struct knob knobs[] = {
    {"sizes", "2.5,5,7.5,10", 0.5, 50, true, "R_G over R_PSF"},
    {"ratios", "0.1,0.5,0.6,0.2", 0, 100, true, "I_N/I_G of the four panels"},
    {"step", "0.075", 0.001, 1, false, "step of the irregular galaxies' random walk over R_G"},
    {0}};

static const char *const fixed[] = {"galaxy",      "psf",           "r-gal",    "step-size",
                                    "noise-ratio", "interpolation", "oversamp", NULL};

static void defaults(struct request *r) {
    r->mock.g1 = -0.031;
    r->mock.g2 = 0.018;
    r->mock.rotate = 1;
    r->mock.r_psf_px = 0.5;
    r->mock.nx = r->mock.ny = 24;
    r->settings.filter = SHEAR_FILTER_PAPER;
    r->settings.background = SHEAR_BACKGROUND_KEEP; /* as the paper's */
    r->settings.zeros = SHEAR_ZEROS_FLOOR;
}

static const struct {
    const char *title, *galaxy, *psf;
    int kind, form;
} panels[N_PANELS] = {
    {"Regular, W_{A}", "regular", "A", SHEAR_MOCK_REGULAR, SHEAR_MOCK_PSF_A},
    {"Regular, W_{B}", "regular", "B", SHEAR_MOCK_REGULAR, SHEAR_MOCK_PSF_B},
    {"Irregular, W_{A}", "irregular", "A", SHEAR_MOCK_IRREGULAR, SHEAR_MOCK_PSF_A},
    {"Irregular, W_{B}", "irregular", "B", SHEAR_MOCK_IRREGULAR, SHEAR_MOCK_PSF_B}};

/* Log-Bicubic and Log-Spline. */
static int method_of(int i) {
    return N_METHODS - N_BEST + i;
}

static int measure(const struct request *r, struct ledger *ledger, int panel, double size,
                   struct tally **tally, shear_error *err) {
    char name[64];
    struct scene scene = {.spec = r->mock};
    struct series series[N_BEST];
    shear_mock_spec *m = &scene.spec;
    m->galaxy = panels[panel].kind;
    m->psf = panels[panel].form;
    m->r_gal_px = size * m->r_psf_px;
    m->step_px = request_number(r, "step") * m->r_gal_px;
    m->noise_ratio = request_list(r, "ratios")->v[panel];
    for (int i = 0; i < N_BEST; i++) {
        series[i] = method_series(0, method_of(i), PSF_FINE, m->r_psf_px, &r->settings);
    }
    snprintf(name, sizeof name, "%s,W_%s,R_G=%g", panels[panel].galaxy, panels[panel].psf, size);
    const sample_spec spec = {.name = name,
                              .stamps = r->galaxies,
                              .groups = r->groups,
                              .threads = r->threads,
                              .n_scenes = 1,
                              .scenes = &scene,
                              .n_series = N_BEST,
                              .series = series};
    return sample_measure(&spec, ledger, tally, err);
}

/* ---- table ---- */

static void add_columns(struct table *t) {
    table_column(t, "galaxy", TABLE_TEXT, 0, "", "kind of the galaxies");
    table_column(t, "psf", TABLE_TEXT, 0, "", "form of the PSF");
    table_column(t, "ratio", TABLE_NUMBER, 2, "", "noise over galaxy, I_N/I_G");
    table_column(t, "size", TABLE_NUMBER, 1, "", "R_G over R_PSF");
    table_column(t, "method", TABLE_TEXT, 0, "", "interpolation");
    table_column(t, "g1", TABLE_NUMBER, 5, "", "measured shear");
    table_column(t, "g1_err", TABLE_NUMBER, 5, "", "its 1-sigma error");
    table_column(t, "pull1", TABLE_NUMBER, 2, "", "(measured - true) / error");
    table_column(t, "g2", TABLE_NUMBER, 5, "", "measured shear");
    table_column(t, "g2_err", TABLE_NUMBER, 5, "", "its 1-sigma error");
    table_column(t, "pull2", TABLE_NUMBER, 2, "", "(measured - true) / error");
}

struct outcome {
    struct curve curves[N_PANELS][2][N_BEST]; /* [panel][component][method] */
    struct tally *all;                        /* of all panels and sizes, in order; owned */
    int large[N_BEST],
        large_good[N_BEST]; /* shears at sizes from 5 on, and those within 3 errors */
    double worst[N_BEST];
};

static const double large = 5.0; /* R_G over R_PSF from which on the paper's claim is tested */

static void take(struct outcome *o, int panel, double size, int i, int c, double g, double err,
                 double pull) {
    struct curve *curve = &o->curves[panel][c][i];
    curve->hue = i != 0 ? SHEAR_BLACK : SHEAR_VERMILION;
    curve->marker = i != 0 ? SHEAR_DISC : SHEAR_SQUARE;
    curve->label = panel == 0 && c == 0 ? methods[method_of(i)].label : NULL;
    curve_add(curve, size, g, err);
    if (size >= large) {
        o->large[i]++;
        o->large_good[i] += fabs(pull) <= 3.0;
        o->worst[i] = fmax(o->worst[i], fabs(pull));
    }
}

static int add_rows(const struct request *r, const struct tally *tally, int panel, double size,
                    struct table *t, struct outcome *o, shear_error *err) {
    for (int i = 0; i < N_BEST; i++) {
        shear_result s;
        int code = tally_result(tally, i, r->mock.rotate > 1, &s, err);
        if (code != SHEAR_OK) {
            return code;
        }
        table_text(t, panels[panel].galaxy);
        table_text(t, panels[panel].psf);
        table_number(t, request_list(r, "ratios")->v[panel]);
        table_number(t, size);
        table_text(t, methods[method_of(i)].label);
        for (int c = 0; c < 2; c++) {
            double g = c != 0 ? s.g2 : s.g1;
            double g_err = c != 0 ? s.g2_err : s.g1_err;
            double pull = (g - (c != 0 ? r->mock.g2 : r->mock.g1)) / g_err;
            table_number(t, g);
            table_number(t, g_err);
            table_number(t, pull);
            take(o, panel, size, i, c, g, g_err, pull);
        }
    }
    return SHEAR_OK;
}

/* Panels and sizes show the same galaxies: all large sizes of a method with their covariance. */
static int judge(const struct request *r, struct table *t, const struct outcome *o,
                 shear_error *err) {
    const knob_values *sizes = request_list(r, "sizes");
    const double truth[] = {r->mock.g1, r->mock.g2};
    int code = SHEAR_OK;
    for (int i = 0; code == SHEAR_OK && i < N_BEST; i++) {
        int series[N_PANELS * MAX_SIZES];
        char text[96];
        struct verdict v = {0};
        int n = 0;
        for (int k = 0; k < N_PANELS * sizes->n; k++) {
            if (sizes->v[k % sizes->n] >= large) {
                series[n++] = N_BEST * k + i;
            }
        }
        code = n > 0 ? report_test(o->all, n, series, truth, &v, err) : SHEAR_OK;
        if (code == SHEAR_OK) {
            table_meta(
                t, "verdict",
                "%s, sizes from %g R_PSF on: %d of %d shears within 3 errors, largest pull %.1f; "
                "with their covariance, %s",
                methods[method_of(i)].label, large, o->large_good[i], o->large[i], o->worst[i],
                report_verdict(&v, text, sizeof text));
        }
    }
    return code;
}

/* ---- figure ---- */

static int draw(const struct request *r, const struct outcome *o, shear_figure **f,
                shear_error *err) {
    enum { ROW = 210 };
    int code = shear_figure_new(f, 860, N_PANELS * ROW + 40, err);
    const shear_grid grid = {.area = {8, 8, 844, N_PANELS * ROW + 24},
                             .rows = N_PANELS,
                             .columns = 2,
                             .gap_x = 10,
                             .gap_y = 4};
    for (int i = 0; code == SHEAR_OK && i < 2 * N_PANELS; i++) {
        int panel = i / 2;
        int c = i % 2;
        char title[80];
        snprintf(title, sizeof title, "%s, I_{N}/I_{G} = %g", panels[panel].title,
                 request_list(r, "ratios")->v[panel]);
        chart_draw(*f, &(struct chart){.cell = shear_grid_cell(&grid, panel, c, 1, 1),
                                       .title = title,
                                       .x_label = panel + 1 == N_PANELS ? "R_{G} / R_{PSF}" : NULL,
                                       .y_label = c != 0 ? "g_{2}" : "g_{1}",
                                       .legend = SHEAR_TOP_RIGHT,
                                       .headroom = i == 0 ? 0.4 : 0.0,
                                       .truth = c != 0 ? r->mock.g2 : r->mock.g1,
                                       .spread = 0.02,
                                       .n_curves = N_BEST,
                                       .curves = o->curves[panel][c]});
    }
    return code;
}

/* ---- all ---- */

static int measure_all(const struct request *r, struct ledger *ledger, struct table *t,
                       struct outcome *o, shear_error *err) {
    const knob_values *sizes = request_list(r, "sizes");
    int code = SHEAR_OK;
    for (int i = 0; code == SHEAR_OK && i < N_PANELS * sizes->n; i++) {
        struct tally *tally = NULL;
        int panel = i / sizes->n;
        double size = sizes->v[i % sizes->n];
        code = measure(r, ledger, panel, size, &tally, err);
        code = code != SHEAR_OK ? code : add_rows(r, tally, panel, size, t, o, err);
        if (o->all == NULL) {
            o->all = tally;
            continue;
        }
        code = code != SHEAR_OK ? code : tally_append(o->all, tally, err);
        tally_free(tally);
    }
    return code;
}

static int check(const struct request *r, shear_error *err) {
    if (request_list(r, "sizes")->n > MAX_SIZES) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "option '--sizes': at most %d", MAX_SIZES);
    }
    if (request_list(r, "ratios")->n != N_PANELS) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "option '--ratios': %d are needed", N_PANELS);
    }
    return SHEAR_OK;
}

static int exec(const struct request *r, shear_error *err) {
    struct ledger *ledger = NULL;
    shear_figure *f = NULL;
    struct table *t = table_new(r);
    int code = check(r, err);
    struct outcome *o = memory_new(1, sizeof *o, "results", &code, err);
    int64_t total = r->galaxies * N_PANELS * request_list(r, "sizes")->n;
    add_columns(t);
    code = code != SHEAR_OK ? code : ledger_open(&ledger, r, total, err);
    code = code != SHEAR_OK ? code : measure_all(r, ledger, t, o, err);
    code = code != SHEAR_OK ? code : judge(r, t, o, err);
    code = code != SHEAR_OK ? code : draw(r, o, &f, err);
    code = code != SHEAR_OK ? code : report_save(r, ledger, t, f, err);
    shear_figure_free(f);
    table_free(t);
    tally_free(o != NULL ? o->all : NULL);
    free(o);
    ledger_close(ledger);
    return code;
}

const experiment exp_overall = {
    .name = "overall",
    .summary = "section 4.4: noise and pixels at once, by size of the galaxies",
    .about =
        "Regular and irregular galaxies under W_A and W_B, R_PSF half a pixel, beta = 1.5 R_PSF, "
        "the\n"
        "paper's filter, point-source noise: four panels of four sizes, each with the two best\n"
        "interpolations. All sizes of a panel show the same galaxies, scaled. The PSF is given "
        "finely\n"
        "sampled.",
    .knobs = knobs,
    .fixed = fixed,
    .defaults = defaults,
    .exec = exec,
};
