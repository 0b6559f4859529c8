/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Experiment `noise` (section 4.2): astronomical noise of increasing brightness, with and without
 * its correction, and four sample images. */
#include "engine/must.h"
#include "engine/sample.h"
#include "experiments/list.h"
#include "report/run.h"

#include <math.h>

static const parameter parameters[] = {
    {"ratios", "0.02,0.05,0.1,0.2,0.5,1,1.5", 1e-6, 1e3, MAX_VALUES, "the values of I_N/I_G"},
    {"pictured", "0.02,0.1,0.5,1.5", 1e-6, 1e3, MAX_VALUES,
     "those of the sample images, at most four"},
    {0}};

static int64_t stamps(const options *o) {
    return o->galaxies * options_list(o, "ratios")->n;
}

/* Measure. Series 2 i and 2 i + 1 are ratio i with and without the correction. */
static void measure(const options *o, cache *c, jackknife_sums *sums) {
    const parameter_values *ratios = options_list(o, "ratios");
    shear_mock_spec noise = o->mock;
    sample s = {"noise", .n_scenes = ratios->n, .n_series = 2 * ratios->n, .noise = &noise};
    noise.noise_ratio = 1.0;
    for (int i = 0; i < s.n_series; i++) {
        s.scenes[i / 2] = (scene){.spec = o->mock, .shared = ratios->v[i / 2]};
        s.series[i] = (series){.scene = i / 2, .settings = o->settings};
        s.series[i].settings.noise_correction = i % 2 == 0;
    }
    sample_measure(o, c, &s, sums);
}

static const column columns[] = {
    {"ratio", TABLE_NUMBER, 2, .help = "mean flux density of the noise over the galaxy's, I_N/I_G"},
    {"corrected", TABLE_TEXT, 0, .help = "whether the noise stamp's moments are subtracted"},
    {"g#", TABLE_NUMBER, 5, .help = "measured shear", .with_error = true},
    {"pull#", TABLE_NUMBER, 2, .help = "(measured - true) / error"},
    {0}};

/* Add the conclusions. The points share galaxies and noise, so the test uses their whole
 * covariance. */
static void conclude(table *t, const jackknife_sums *sums, double worst, double last_ratio,
                     double left, const double truth[2]) {
    char text[96];
    int corrected[MAX_VALUES];
    const int n = sums->n_series / 2;
    for (int i = 0; i < n; i++)
        corrected[i] = 2 * i;
    const chi_square test = jackknife_test(sums, n, corrected, truth);
    table_meta(t, "worst_pull", "%.3f", worst);
    table_meta(t, "chi2", "%.3f", test.chi2);
    table_meta(t, "dof", "%d", test.dof);
    table_meta(t, "p", "%.4g", test.p);
    table_meta(t, TABLE_CONCLUSION,
               "corrected: largest pull %.1f; all points with their covariance, %s; "
               "uncorrected at I_N/I_G = %g: %.0f %% of the shear is left",
               worst, chi_square_text(&test, text, sizeof text), last_ratio, left);
}

/* Fill the table and curves [component][corrected, not]. */
static void tabulate(run *r, const jackknife_sums *sums, curve curves[2][2]) {
    const options *o = r->options;
    const parameter_values *ratios = options_list(o, "ratios");
    const double truth[] = {o->mock.g1, o->mock.g2};
    double worst = 0.0;
    jackknife_shear s = {0};
    table_columns(r->table, columns);
    for (int i = 0; i < sums->n_series; i++) {
        const double ratio = ratios->v[i / 2];
        s = jackknife_shear_of(sums, i, o->mock.rotate > 1, truth);
        table_numbers(r->table, ratio);
        table_texts(r->table, i % 2 != 0 ? "no" : "yes");
        for (int c = 0; c < 2; c++) {
            table_numbers(r->table, s.g[c], s.err[c], s.pull[c]);
            worst = i % 2 != 0 ? worst : fmax(worst, fabs(s.pull[c]));
            curve_add(&curves[c][i % 2], ratio, s.g[c], s.err[c]);
        }
    }
    conclude(r->table, sums, worst, ratios->v[ratios->n - 1], 100.0 * s.g[1] / truth[1], truth);
}

static void draw(run *r, curve curves[2][2]) {
    const double truth[] = {r->options->mock.g1, r->options->mock.g2};
    const panels p =
        run_panels(r, NULL, 760, 640, (shear_grid){.rows = 2, .columns = 1, .gap_y = 4});
    for (int c = 0; c < 2; c++) {
        panels_draw(&p, c,
                    &(chart){NULL, c != 0 ? "I_{N} / I_{G}" : NULL, c != 0 ? "g_{2}" : "g_{1}",
                             .log_x = true, .legend = SHEAR_BOTTOM_LEFT, .truth = truth[c],
                             .spread = 0.012, .n_curves = 2, .curves = curves[c]});
    }
}

static void draw_image(const options *o, shear_figure *f, shear_rect cell, double ratio) {
    shear_mock_spec m = o->mock;
    char title[40];
    m.noise_ratio = ratio;
    CLEANUP(release_free) double *galaxy = sampler_draw(&m, 1);
    snprintf(title, sizeof title, "I_{N}/I_{G} = %g", ratio);
    shear_image_begin(f, &(shear_image){cell, title, galaxy, m.nx, m.ny, .map = SHEAR_MAP_GREY,
                                        .percentiles = {0.0, 99.95}});
    shear_axes_end(f);
}

static void draw_images(run *r) {
    const parameter_values *ratios = options_list(r->options, "pictured");
    const shear_grid grid = {{6, 6, 588, 628}, .rows = 2, .columns = 2, .gap_x = 6, .gap_y = 6};
    shear_figure *f = run_figure(r, "images", 600, 640);
    for (int i = 0; i < ratios->n && i < 4; i++)
        draw_image(r->options, f, shear_grid_cell(&grid, i / 2, i % 2, 1, 1), ratios->v[i]);
}

static void run_noise(run *r) {
    curve curves[2][2] = {{{.label = "noise corrected", .hue = SHEAR_VERMILION},
                           {.label = "not corrected", .hue = SHEAR_BLUE, .marker = SHEAR_SQUARE}},
                          {{.hue = SHEAR_VERMILION}, {.hue = SHEAR_BLUE, .marker = SHEAR_SQUARE}}};
    CLEANUP(jackknife_sums_deinit) jackknife_sums sums = {0};
    measure(r->options, r->cache, &sums);
    tabulate(r, &sums, curves);
    draw(r, curves);
    draw_images(r);
}

const experiment experiment_noise = {
    "noise",
    "section 4.2: shear under noise of growing brightness, corrected and not",
    "Regular galaxies of 600 points on 256x256 pixels, R_G = 30, W_A with R_PSF = 4, beta =\n"
    "6, the paper's filter, under point-source noise whose mean flux density is I_N/I_G times\n"
    "the galaxy's. All ratios show the same galaxies and the same noise, scaled. Also leaves\n"
    "noise-images.png: one galaxy at four ratios.",
    .defaults = "size=256 shear=0.023,-0.037 rotate=1 r-gal=30 r-psf=4 interpolation=none "
                "filter=paper background=keep",
    .fixed = "noise-ratio noise-correction no-noise-correction",
    .parameters = parameters,
    .stamps = stamps,
    .run = run_noise};
