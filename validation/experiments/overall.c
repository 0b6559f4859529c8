/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Experiment `overall` (section 4.4): noise and pixels together; both kinds of galaxies with both
 * PSFs, in four sizes. */
#include "engine/methods.h"
#include "engine/must.h"
#include "experiments/list.h"
#include "report/run.h"

#include <math.h>

enum { N_PANELS = 4, N_BEST = 2, MAX_SIZES = 8, ROW = 210 };

static const parameter parameters[] = {
    {"sizes", "2.5,5,7.5,10", 0.5, 50, MAX_SIZES, "R_G over R_PSF"},
    {"ratios", "0.1,0.5,0.6,0.2", 0, 100, MAX_VALUES, "I_N/I_G of the four panels"},
    {"step", "0.075", 0.001, 1, 1, "step of the irregular galaxies' random walk over R_G"},
    {0}};

static int64_t stamps(const options *o) {
    if (options_list(o, "ratios")->n != N_PANELS)
        must_fail(SHEAR_E_SETTING, NULL, "option '--ratios': %d are needed", N_PANELS);
    return o->galaxies * N_PANELS * options_list(o, "sizes")->n;
}

static const struct {
    const char *title, *galaxy, *psf;
    enum shear_mock_galaxy kind;
    enum shear_mock_psf form;
} kinds[N_PANELS] = {
    {"Regular, W_{A}", "regular", "A", SHEAR_MOCK_REGULAR, SHEAR_MOCK_PSF_A},
    {"Regular, W_{B}", "regular", "B", SHEAR_MOCK_REGULAR, SHEAR_MOCK_PSF_B},
    {"Irregular, W_{A}", "irregular", "A", SHEAR_MOCK_IRREGULAR, SHEAR_MOCK_PSF_A},
    {"Irregular, W_{B}", "irregular", "B", SHEAR_MOCK_IRREGULAR, SHEAR_MOCK_PSF_B}};

/* Return the index of Log-Bicubic or Log-Spline. */
static int method_of(int i) {
    return N_METHODS - N_BEST + i;
}

static void measure(const options *o, cache *c, int panel, double size, jackknife_sums *sums) {
    sample s = {.n_scenes = 1, .scenes = {{.spec = o->mock}}, .n_series = N_BEST};
    shear_mock_spec *m = &s.scenes[0].spec;
    m->galaxy = kinds[panel].kind;
    m->psf = kinds[panel].form;
    m->r_gal_px = size * m->r_psf_px;
    m->step_px = options_number(o, "step") * m->r_gal_px;
    m->noise_ratio = options_list(o, "ratios")->v[panel];
    for (int i = 0; i < N_BEST; i++)
        s.series[i] = method_series(method_of(i), PSF_FINE, m->r_psf_px, &o->settings);
    snprintf(s.name, sizeof s.name, "%s,W_%s,R_G=%g", kinds[panel].galaxy, kinds[panel].psf, size);
    sample_measure(o, c, &s, sums);
}

/* ---- table ---- */

static const column columns[] = {
    {"galaxy", TABLE_TEXT, 0, .help = "kind of the galaxies"},
    {"psf", TABLE_TEXT, 0, .help = "form of the PSF"},
    {"ratio", TABLE_NUMBER, 2, .help = "noise over galaxy, I_N/I_G"},
    {"size", TABLE_NUMBER, 1, .help = "R_G over R_PSF"},
    {"method", TABLE_TEXT, 0, .help = "interpolation"},
    {"g#", TABLE_NUMBER, 5, .help = "measured shear", .with_error = true},
    {"pull#", TABLE_NUMBER, 2, .help = "(measured - true) / error"},
    {0}};

typedef struct outcome {
    curve curves[N_PANELS][2][N_BEST]; /* [panel][component][method] */
    /* number of shears at sizes from 5 on, those within 3 errors, and the largest pull */
    int large[N_BEST], large_good[N_BEST];
    double worst[N_BEST];
} outcome;

static const double large = 5.0; /* R_G over R_PSF from which the paper's claim is tested */

static void add_row(run *r, int panel, double size, int i, const jackknife_shear *s, outcome *out) {
    const method *m = &methods[method_of(i)];
    table_texts(r->table, kinds[panel].galaxy, kinds[panel].psf);
    table_numbers(r->table, options_list(r->options, "ratios")->v[panel], size);
    table_texts(r->table, m->label);
    for (int c = 0; c < 2; c++) {
        curve *of = &out->curves[panel][c][i];
        of->hue = i != 0 ? SHEAR_BLACK : SHEAR_VERMILION;
        of->marker = i != 0 ? SHEAR_DISC : SHEAR_SQUARE;
        of->label = panel == 0 && c == 0 ? m->label : NULL;
        curve_add(of, size, s->g[c], s->err[c]);
        table_numbers(r->table, s->g[c], s->err[c], s->pull[c]);
        if (size >= large) {
            out->large[i]++;
            out->large_good[i] += fabs(s->pull[c]) <= 3.0;
            out->worst[i] = fmax(out->worst[i], fabs(s->pull[c]));
        }
    }
}

/* Fill the table, and the sums of all panels and sizes, in order. */
static void tabulate(run *r, jackknife_sums *all, outcome *out) {
    const options *o = r->options;
    const parameter_values *sizes = options_list(o, "sizes");
    const double truth[] = {o->mock.g1, o->mock.g2};
    table_columns(r->table, columns);
    for (int k = 0; k < N_PANELS * sizes->n; k++) {
        const double size = sizes->v[k % sizes->n];
        measure(o, r->cache, k / sizes->n, size, all);
        for (int i = 0; i < N_BEST; i++) {
            const bool rotated = o->mock.rotate > 1;
            const jackknife_shear s = jackknife_shear_of(all, N_BEST * k + i, rotated, truth);
            add_row(r, k / sizes->n, size, i, &s, out);
        }
    }
}

/* Add a conclusion: panels and sizes show the same galaxies, so all large sizes of a method are
 * tested with their covariance. */
static void conclude(run *r, const jackknife_sums *all, const outcome *out, int i) {
    const parameter_values *sizes = options_list(r->options, "sizes");
    const double truth[] = {r->options->mock.g1, r->options->mock.g2};
    int series_of[N_PANELS * MAX_SIZES];
    char text[96];
    chi_square test = {0};
    int n = 0;
    for (int k = 0; k < N_PANELS * sizes->n; k++) {
        if (sizes->v[k % sizes->n] >= large)
            series_of[n++] = N_BEST * k + i;
    }
    if (n > 0)
        test = jackknife_test(all, n, series_of, truth);
    table_meta(r->table, TABLE_CONCLUSION,
               "%s, sizes from %g R_PSF on: %d of %d shears within 3 errors, largest pull %.1f; "
               "with their covariance, %s",
               methods[method_of(i)].label, large, out->large_good[i], out->large[i], out->worst[i],
               chi_square_text(&test, text, sizeof text));
}

static void draw(run *r, const outcome *out) {
    const double truth[] = {r->options->mock.g1, r->options->mock.g2};
    const double *ratios = options_list(r->options, "ratios")->v;
    const panels p =
        run_panels(r, NULL, 860, N_PANELS * ROW + 40,
                   (shear_grid){.rows = N_PANELS, .columns = 2, .gap_x = 10, .gap_y = 4});
    for (int i = 0; i < 2 * N_PANELS; i++) {
        const int panel = i / 2;
        char title[80];
        snprintf(title, sizeof title, "%s, I_{N}/I_{G} = %g", kinds[panel].title, ratios[panel]);
        panels_draw(&p, i,
                    &(chart){title, panel + 1 == N_PANELS ? "R_{G} / R_{PSF}" : NULL,
                             i % 2 != 0 ? "g_{2}" : "g_{1}", .legend = SHEAR_TOP_RIGHT,
                             .headroom = i == 0 ? 0.4 : 0.0, .truth = truth[i % 2], .spread = 0.02,
                             .n_curves = N_BEST, .curves = out->curves[panel][i % 2]});
    }
}

static void run_overall(run *r) {
    static outcome out;
    CLEANUP(jackknife_sums_deinit) jackknife_sums sums = {0};
    tabulate(r, &sums, &out);
    for (int i = 0; i < N_BEST; i++)
        conclude(r, &sums, &out, i);
    draw(r, &out);
}

const experiment experiment_overall = {
    "overall",
    "section 4.4: noise and pixels at once, by size of the galaxies",
    "Regular and irregular galaxies under W_A and W_B, R_PSF half a pixel, beta = 1.5 R_PSF,\n"
    "the paper's filter, point-source noise: four panels of four sizes, each with the two\n"
    "best interpolations. All sizes of a panel show the same galaxies, scaled. The PSF is\n"
    "given finely sampled.",
    .defaults =
        "shear=-0.031,0.018 rotate=1 r-psf=0.5 size=24 filter=paper background=keep zeros=floor",
    .fixed = "galaxy psf r-gal step-size noise-ratio interpolation oversamp",
    .parameters = parameters,
    .stamps = stamps,
    .run = run_overall};
