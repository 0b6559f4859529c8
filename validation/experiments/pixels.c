/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Experiment `pixels` (section 4.3, last figure): the six interpolations as functions of the pixel
 * size. */
#include "engine/methods.h"
#include "engine/must.h"
#include "experiments/list.h"
#include "report/run.h"

#include <math.h>

enum { MAX_SIZES = 3 };

static const parameter parameters[] = {
    {"ratios", "0.25,0.5,0.75,1,1.25,1.5,2,2.5,3", 0.05, 8, MAX_VALUES, "pixel size over R_PSF"},
    {"sizes", "6.67,3.33,1.67", 0.5, 50, MAX_SIZES, "R_G over R_PSF, at most three"},
    {"step", "0.075", 0.001, 1, 1, "step of the random walk over R_G"},
    {"beta", "1.33333333333333333", 0.5, 10, 1, "beta over R_PSF"},
    {"coarse", "1", 0, 1, 1, "1: also with the PSF as coarse as the pixels"},
    {0}};

static int64_t stamps(const options *o) {
    return o->galaxies * options_list(o, "sizes")->n * (options_list(o, "ratios")->n + 1);
}

/* Return how many of enum psf_sampling are measured. */
static int samplings(const options *o) {
    return options_number(o, "coarse") > 0.0 ? N_PSF_SAMPLINGS : 1;
}

/* ---- measuring ---- */

/* Return the scene of galaxies of R_G = size * R_PSF with R_PSF = ratio pixels. */
static scene scene_at(const options *o, double size, double ratio) {
    scene s = {.spec = o->mock};
    s.spec.r_psf_px = 1.0 / ratio;
    s.spec.r_gal_px = size / ratio;
    s.spec.step_px = options_number(o, "step") * s.spec.r_gal_px;
    s.spec.nx = s.spec.ny = stamp_side(s.spec.r_gal_px, s.spec.r_psf_px);
    return s;
}

static shear_settings settings_at(const options *o, double ratio) {
    shear_settings s = o->settings;
    s.beta_px = options_number(o, "beta") / ratio;
    return s;
}

/* Measure without the effect of pixels: R_PSF = 4 pixels, not interpolated. */
static void measure_reference(const options *o, cache *c, double size, jackknife_sums *sums) {
    static const double fine = 0.25;
    sample s = {.n_scenes = 1,
                .scenes = {scene_at(o, size, fine)},
                .n_series = 1,
                .series = {{.settings = settings_at(o, fine)}}};
    s.series[0].settings.interpolation = SHEAR_INTERP_NONE;
    s.series[0].settings.oversample = 0;
    snprintf(s.name, sizeof s.name, "reference:R_G=%g", size);
    sample_measure(o, c, &s, sums);
}

static void measure_ratio(const options *o, cache *c, double size, double ratio,
                          jackknife_sums *sums) {
    sample s = {
        .n_scenes = 1, .scenes = {scene_at(o, size, ratio)}, .n_series = samplings(o) * N_METHODS};
    const shear_settings settings = settings_at(o, ratio);
    method_series_all(s.series, 1.0 / ratio, &settings);
    snprintf(s.name, sizeof s.name, "R_G=%g,pixel=%g", size, ratio);
    sample_measure(o, c, &s, sums);
}

/* Measure the well-sampled reference (series 0) and, for each ratio, the six methods with each
 * sampling of the PSF. */
static void measure_size(const options *o, cache *c, double size, jackknife_sums *sums) {
    const parameter_values *ratios = options_list(o, "ratios");
    measure_reference(o, c, size, sums);
    for (int k = 0; k < ratios->n; k++)
        measure_ratio(o, c, size, ratios->v[k], sums);
}

/* ---- one point ---- */

typedef struct point {
    double size, ratio;
    int method;
    double g[2], err[2], pull[2]; /* against the true shear */
    double dev[2], dev_err[2];    /* from the well-sampled reference */
    double gain, gain_err;        /* |dev| without the logarithm minus |dev| */
} point;

/* Indices of series in a size's sums; `twin` is the method without the logarithm, or the same
 * series. */
typedef struct pick {
    int series, twin;
} pick;

/* Compute g1, g2, dev1, dev2, and |dev| of the twin minus |dev|. */
static void estimate(const jackknife_total *totals, const void *context, double *out) {
    const pick *p = context;
    const double *reference = totals[0].g;
    const double *own = totals[p->series].g;
    const double *twin = totals[p->twin].g;
    for (int c = 0; c < 2; c++) {
        out[c] = own[c];
        out[2 + c] = own[c] - reference[c];
    }
    out[4] = hypot(twin[0] - reference[0], twin[1] - reference[1]) - hypot(out[2], out[3]);
}

/* Fill a point. `first` is the series of the first method for the point's ratio and sampling. */
static void fill_point(point *p, const jackknife_sums *sums, int first, const double truth[2]) {
    enum { N = 5 };
    double v[N];
    double cov[N * N];
    const int plain = methods[p->method].plain;
    const pick which = {first + p->method, first + (plain >= 0 ? plain : p->method)};
    jackknife_covariance(sums, estimate, &which, N, v, cov);
    for (int c = 0; c < 2; c++) {
        p->g[c] = v[c];
        p->err[c] = sqrt(cov[c * N + c]);
        p->pull[c] = (v[c] - truth[c]) / p->err[c];
        p->dev[c] = v[2 + c];
        p->dev_err[c] = sqrt(cov[(2 + c) * N + 2 + c]);
    }
    p->gain = plain >= 0 ? v[4] : NAN;
    p->gain_err = plain >= 0 ? sqrt(cov[4 * N + 4]) : NAN;
}

/* ---- table ---- */

static const column columns[] = {
    {"size", TABLE_NUMBER, 2, .help = "R_G over R_PSF"},
    {"ratio", TABLE_NUMBER, 2, .help = "pixel size over R_PSF"},
    {"method", TABLE_TEXT, 0, .help = "interpolation"},
    {"psf", TABLE_TEXT, 0,
     .help = "PSF given finely sampled, or interpolated from the same pixels"},
    {"g#", TABLE_NUMBER, 5, .help = "measured shear"},
    {"g#_err", TABLE_NUMBER, 5, .help = "its 1-sigma error (jackknife)"},
    {"pull#", TABLE_NUMBER, 2, .help = "(measured - true) / error"},
    {"dev#", TABLE_NUMBER, 5, .help = "measured, minus well sampled, the same galaxies",
     .with_error = true},
    {"gain", TABLE_NUMBER, 5, .help = "|deviation| without the logarithm minus with it",
     .with_error = true},
    {0}};

static void add_row(table *t, int psf, const point *p) {
    table_numbers(t, p->size, p->ratio);
    table_texts(t, methods[p->method].label, psf_sampling_names[psf]);
    for (int c = 0; c < 2; c++)
        table_numbers(t, p->g[c], p->err[c], p->pull[c], p->dev[c], p->dev_err[c]);
    table_numbers(t, p->gain, p->gain_err);
}

typedef struct score {
    int best, best_good; /* points of the two best methods up to ratio 2; those within 3 errors */
    double worst;        /* the largest pull of these */
    int twins, better, worse; /* methods with a twin; those better or worse by 3 errors */
} score;

static void score_point(score *s, const point *p) {
    for (int c = 0; c < 2 && p->method >= N_METHODS - 2 && p->ratio <= 2.0; c++) {
        s->best++;
        s->best_good += fabs(p->pull[c]) <= 3.0;
        s->worst = fmax(s->worst, fabs(p->pull[c]));
    }
    if (methods[p->method].plain >= 0) {
        s->twins++;
        s->better += p->gain > 3.0 * p->gain_err;
        s->worse += p->gain < -3.0 * p->gain_err;
    }
}

static void conclude(table *t, const char *psf, const score *s) {
    table_meta(t, TABLE_CONCLUSION,
               "%s PSF: Log-Bicubic and Log-Spline up to pixel/R_PSF = 2: %d of %d shears "
               "within 3 errors, largest pull %.1f",
               psf, s->best_good, s->best, s->worst);
    table_meta(t, TABLE_CONCLUSION,
               "%s PSF: with the logarithm nearer to the well-sampled shear in %d of %d cases, "
               "farther in %d, alike in %d",
               psf, s->better, s->twins, s->worse, s->twins - s->better - s->worse);
}

/* ---- figures, one per sampling ---- */

typedef curve curves[MAX_SIZES][2][N_METHODS]; /* [size][component][method] */

static void add_point(curves all, int size, const point *p) {
    const method *m = &methods[p->method];
    for (int c = 0; c < 2; c++) {
        curve *of = &all[size][c][p->method];
        of->hue = m->hue;
        of->marker = m->marker;
        of->label = size == 0 && c == 0 ? m->label : NULL;
        curve_add(of, p->ratio, p->g[c], p->err[c]);
    }
}

static void draw(run *r, const char *suffix, curves all) {
    const parameter_values *sizes = options_list(r->options, "sizes");
    const double truth[] = {r->options->mock.g1, r->options->mock.g2};
    const panels p =
        run_panels(r, suffix, 980, 250 * sizes->n + 40,
                   (shear_grid){.rows = sizes->n, .columns = 2, .gap_x = 10, .gap_y = 4});
    for (int i = 0; i < 2 * sizes->n; i++) {
        const bool last = i / 2 + 1 == sizes->n;
        char title[48];
        snprintf(title, sizeof title, "R_{G} = %g R_{PSF}", sizes->v[i / 2]);
        panels_draw(&p, i,
                    &(chart){title, last ? "pixel size / R_{PSF}" : NULL,
                             i % 2 != 0 ? "g_{2}" : "g_{1}", .legend = SHEAR_TOP_LEFT,
                             .truth = truth[i % 2], .spread = 0.008, .headroom = i == 0 ? 0.9 : 0.0,
                             .n_curves = N_METHODS, .curves = all[i / 2][i % 2]});
    }
}

/* ---- all ---- */

static void do_sampling(run *r, const jackknife_sums *sums, int psf) {
    const options *o = r->options;
    const parameter_values *sizes = options_list(o, "sizes");
    const parameter_values *ratios = options_list(o, "ratios");
    const double truth[] = {o->mock.g1, o->mock.g2};
    CLEANUP(release_free) curves *all = must_allocate(1, sizeof *all, "curves");
    score s = {0};
    for (int i = 0; i < sizes->n * ratios->n * N_METHODS; i++) {
        const int k = i / N_METHODS % ratios->n;
        const int size = i / N_METHODS / ratios->n;
        point p = {.size = sizes->v[size], .ratio = ratios->v[k], .method = i % N_METHODS};
        fill_point(&p, &sums[size], 1 + (k * samplings(o) + psf) * N_METHODS, truth);
        add_row(r->table, psf, &p);
        add_point(*all, size, &p);
        score_point(&s, &p);
    }
    conclude(r->table, psf_sampling_names[psf], &s);
    draw(r, psf == PSF_FINE ? NULL : "coarse", *all);
}

static void run_pixels(run *r) {
    const parameter_values *sizes = options_list(r->options, "sizes");
    jackknife_sums sums[MAX_SIZES] = {{0}};
    table_columns(r->table, columns);
    for (int i = 0; i < sizes->n; i++)
        measure_size(r->options, r->cache, sizes->v[i], &sums[i]);
    for (int psf = 0; psf < samplings(r->options); psf++)
        do_sampling(r, sums, psf);
    for (int i = 0; i < sizes->n; i++)
        jackknife_sums_deinit(&sums[i]);
}

const experiment experiment_pixels = {
    "pixels",
    "section 4.3: shear against the size of the pixels, six interpolations",
    "Irregular galaxies of 1000 steps under W_B, beta = 4/3 R_PSF, without noise, in three\n"
    "sizes (R_G and step 6.67 and 0.5, 3.33 and 0.25, 1.67 and 0.125 R_PSF). The PSF is given\n"
    "finely sampled, and again as coarse as the pixels (pixels-coarse.png). Beside the true\n"
    "shear stands what the same galaxies give where pixels do not matter (R_PSF = 4 pixels):\n"
    "deviations from it are free of the scatter of the galaxies' shapes.",
    .defaults = "shear=-0.031,0.018 rotate=1 galaxy=irregular psf=b filter=none zeros=floor",
    .fixed = "size r-gal r-psf step-size beta beta-ratio interpolation oversamp",
    .parameters = parameters,
    .stamps = stamps,
    .run = run_pixels};
