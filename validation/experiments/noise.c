/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Section 4.2 of the paper: astronomical noise of growing brightness, with and without its
 * correction, and four sample images. */
#include "engine/experiment.h"
#include "engine/sample.h"
#include "report/chart.h"
#include "report/run.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

static const struct knob knobs[] = {
    {"ratios", "0.02,0.05,0.1,0.2,0.5,1,1.5", 1e-6, 1e3, true, "the values of I_N/I_G"},
    {"pictured", "0.02,0.1,0.5,1.5", 1e-6, 1e3, true, "those of the sample images, at most four"},
    {0}};

static const char *const fixed[] = {"noise-ratio", "noise-correction", "no-noise-correction", NULL};

static void defaults(struct request *r) {
    shear_mock_spec *m = &r->mock;
    m->nx = m->ny = 256;
    m->g1 = 0.023;
    m->g2 = -0.037;
    m->rotate = 1;
    m->r_gal_px = 30.0;
    m->r_psf_px = 4.0;
    r->settings.interpolation = SHEAR_INTERP_NONE;
    r->settings.filter = SHEAR_FILTER_PAPER;
    r->settings.background = SHEAR_BACKGROUND_KEEP; /* as the paper's */
}

/* Series 2 i and 2 i + 1 are ratio i with and without the correction. */
static int measure(const struct request *r, struct ledger *ledger, struct tally **tally,
                   shear_error *err) {
    const knob_values *ratios = request_list(r, "ratios");
    struct scene scenes[MAX_KNOB_VALUES];
    struct series series[2 * MAX_KNOB_VALUES];
    shear_mock_spec noise = r->mock;
    noise.noise_ratio = 1.0;
    for (int i = 0; i < ratios->n; i++) {
        scenes[i] = (struct scene){.spec = r->mock, .shared = ratios->v[i]};
        for (int k = 0; k < 2; k++) {
            series[2 * i + k] = (struct series){.scene = i, .settings = r->settings};
            series[2 * i + k].settings.noise_correction = k == 0;
        }
    }
    const sample_spec spec = {.name = "noise",
                              .stamps = r->galaxies,
                              .groups = r->groups,
                              .threads = r->threads,
                              .n_scenes = ratios->n,
                              .scenes = scenes,
                              .n_series = 2 * ratios->n,
                              .series = series,
                              .noise = &noise};
    return sample_measure(&spec, ledger, tally, err);
}

/* ---- table ---- */

static void add_columns(struct table *t) {
    table_column(t, "ratio", TABLE_NUMBER, 2, "",
                 "mean flux density of the noise over the galaxy's, I_N/I_G");
    table_column(t, "corrected", TABLE_TEXT, 0, "",
                 "whether the noise stamp's moments are subtracted");
    table_column(t, "g1", TABLE_NUMBER, 5, "", "measured shear");
    table_column(t, "g1_err", TABLE_NUMBER, 5, "", "its 1-sigma error");
    table_column(t, "pull1", TABLE_NUMBER, 2, "", "(measured - true) / error");
    table_column(t, "g2", TABLE_NUMBER, 5, "", "measured shear");
    table_column(t, "g2_err", TABLE_NUMBER, 5, "", "its 1-sigma error");
    table_column(t, "pull2", TABLE_NUMBER, 2, "", "(measured - true) / error");
}

struct outcome {
    struct curve curves[2][2]; /* [component][corrected, not] */
    double worst;              /* largest |pull| of the corrected points */
};

static int add_rows(const struct request *r, const struct tally *tally, struct table *t,
                    struct outcome *o, shear_error *err) {
    const knob_values *ratios = request_list(r, "ratios");
    bool jackknife = r->mock.rotate > 1;
    for (int i = 0; i < tally->n_series; i++) {
        shear_result s;
        int code = tally_result(tally, i, jackknife, &s, err);
        if (code != SHEAR_OK) {
            return code;
        }
        double pull1 = (s.g1 - r->mock.g1) / s.g1_err;
        double pull2 = (s.g2 - r->mock.g2) / s.g2_err;
        table_number(t, ratios->v[i / 2]);
        table_text(t, i % 2 ? "no" : "yes");
        for (int c = 0; c < 2; c++) {
            table_number(t, c != 0 ? s.g2 : s.g1);
            table_number(t, c != 0 ? s.g2_err : s.g1_err);
            table_number(t, c != 0 ? pull2 : pull1);
        }
        o->worst = i % 2 ? o->worst : fmax(o->worst, fmax(fabs(pull1), fabs(pull2)));
        curve_add(&o->curves[0][i % 2], ratios->v[i / 2], s.g1, s.g1_err);
        curve_add(&o->curves[1][i % 2], ratios->v[i / 2], s.g2, s.g2_err);
    }
    return SHEAR_OK;
}

/* The points share galaxies and noise, so that only their whole covariance can judge them. */
static int judge(const struct request *r, const struct tally *tally, struct table *t,
                 const struct outcome *o, shear_error *err) {
    char text[96];
    struct verdict v;
    int corrected[MAX_KNOB_VALUES];
    const double truth[] = {r->mock.g1, r->mock.g2};
    int n = request_list(r, "ratios")->n;
    for (int i = 0; i < n; i++) {
        corrected[i] = 2 * i;
    }
    int code = report_test(tally, n, corrected, truth, &v, err);
    if (code == SHEAR_OK) {
        table_meta(t, "worst_pull", "%.3f", o->worst);
        table_meta(t, "chi2", "%.3f", v.chi2);
        table_meta(t, "dof", "%d", v.dof);
        table_meta(t, "p", "%.4g", v.p);
        table_meta(t, "verdict",
                   "corrected: largest pull %.1f; all points with their covariance, %s; "
                   "uncorrected at I_N/I_G = %g: %.0f %% of the shear is left",
                   o->worst, report_verdict(&v, text, sizeof text),
                   o->curves[0][1].x[o->curves[0][1].n - 1],
                   100.0 * o->curves[1][1].y[o->curves[1][1].n - 1] / r->mock.g2);
    }
    return code;
}

/* ---- figures ---- */

static int draw(const struct request *r, struct outcome *o, shear_figure **figure,
                shear_error *err) {
    int code = shear_figure_new(figure, 760, 640, err);
    if (code != SHEAR_OK) {
        return code;
    }
    const shear_grid grid = {.area = {8, 8, 744, 624}, .rows = 2, .columns = 1, .gap_y = 4};
    for (int c = 0; c < 2; c++) {
        o->curves[c][0].hue = SHEAR_VERMILION;
        o->curves[c][1].hue = SHEAR_BLUE;
        o->curves[c][1].marker = SHEAR_SQUARE;
        o->curves[c][0].label = c != 0 ? NULL : "noise corrected";
        o->curves[c][1].label = c != 0 ? NULL : "not corrected";
        chart_draw(*figure, &(struct chart){.cell = shear_grid_cell(&grid, c, 0, 1, 1),
                                            .x_label = c != 0 ? "I_{N} / I_{G}" : NULL,
                                            .y_label = c != 0 ? "g_{2}" : "g_{1}",
                                            .log_x = true,
                                            .legend = SHEAR_BOTTOM_LEFT,
                                            .truth = c != 0 ? r->mock.g2 : r->mock.g1,
                                            .spread = 0.012,
                                            .n_curves = 2,
                                            .curves = o->curves[c]});
    }
    return SHEAR_OK;
}

static int draw_image(const struct request *r, shear_figure *f, shear_rect cell, double ratio,
                      shear_error *err) {
    shear_mock_spec m = r->mock;
    shear_mock *mock = NULL;
    char title[40];
    m.n_stamps = 1;
    m.noise_ratio = ratio;
    size_t pixels = (size_t)m.nx * (size_t)m.ny;
    double *galaxy = calloc(2 * pixels, sizeof *galaxy);
    int code = galaxy != NULL ? shear_mock_new(&mock, &m, err)
                              : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for an image");
    code = code != SHEAR_OK ? code : shear_mock_stamps(mock, 0, 1, 1, galaxy, galaxy + pixels, err);
    if (code == SHEAR_OK) {
        snprintf(title, sizeof title, "I_{N}/I_{G} = %g", ratio);
        shear_image_begin(f, &(shear_image){.cell = cell,
                                            .title = title,
                                            .pixels = galaxy,
                                            .nx = m.nx,
                                            .ny = m.ny,
                                            .map = SHEAR_MAP_GREY,
                                            .percentiles = {0.0, 99.95}});
        shear_axes_end(f);
    }
    shear_mock_free(mock);
    free(galaxy);
    return code;
}

static int draw_images(const struct request *r, shear_error *err) {
    const knob_values *ratios = request_list(r, "pictured");
    shear_figure *f = NULL;
    const shear_grid grid = {
        .area = {6, 6, 588, 628}, .rows = 2, .columns = 2, .gap_x = 6, .gap_y = 6};
    int code = shear_figure_new(&f, 600, 640, err);
    for (int i = 0; code == SHEAR_OK && i < ratios->n && i < 4; i++) {
        code = draw_image(r, f, shear_grid_cell(&grid, i / 2, i % 2, 1, 1), ratios->v[i], err);
    }
    code = code != SHEAR_OK ? code : report_picture(r, "images", f, err);
    shear_figure_free(f);
    return code;
}

static int finish(const struct request *r, const struct ledger *ledger, const struct tally *tally,
                  shear_error *err) {
    struct outcome o = {.worst = 0.0};
    struct table *t = table_new(r);
    shear_figure *f = NULL;
    add_columns(t);
    int code = add_rows(r, tally, t, &o, err);
    code = code != SHEAR_OK ? code : judge(r, tally, t, &o, err);
    code = code != SHEAR_OK ? code : draw(r, &o, &f, err);
    code = code != SHEAR_OK ? code : report_save(r, ledger, t, f, err);
    shear_figure_free(f);
    table_free(t);
    return code;
}

static int exec(const struct request *r, shear_error *err) {
    struct ledger *ledger = NULL;
    struct tally *tally = NULL;
    int code = ledger_open(&ledger, r, r->galaxies * request_list(r, "ratios")->n, err);
    code = code != SHEAR_OK ? code : measure(r, ledger, &tally, err);
    code = code != SHEAR_OK ? code : finish(r, ledger, tally, err);
    code = code != SHEAR_OK ? code : draw_images(r, err);
    tally_free(tally);
    ledger_close(ledger);
    return code;
}

const experiment exp_noise = {
    .name = "noise",
    .summary = "section 4.2: shear under noise of growing brightness, corrected and not",
    .about = "Regular galaxies of 600 points on 256x256 pixels, R_G = 30, W_A with R_PSF = 4, beta "
             "= 6,\n"
             "the paper's filter, under point-source noise whose mean flux density is I_N/I_G "
             "times the\n"
             "galaxy's. All ratios show the same galaxies and the same noise, scaled. Also leaves\n"
             "noise-images.png: one galaxy at four ratios.",
    .knobs = knobs,
    .fixed = fixed,
    .defaults = defaults,
    .exec = exec,
};
