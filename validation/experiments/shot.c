/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Experiment `shot` (the paper's discussion): m and c with photon counting, as functions of the
 * exposure. */
#include "engine/bias_fit.h"
#include "engine/methods.h"
#include "engine/must.h"
#include "experiments/list.h"
#include "report/run.h"

#include <math.h>

enum { N_PANELS = 3, N_SHEARS = 5, N_WAYS = 3 };

static const parameter parameters[] = {
    {"snrs", "0.01,0.1,1", 1e-6, 1e4, MAX_VALUES,
     "mean surface brightness, galaxy over background: the three panels"},
    {"photons-1", "1e3,1e4,1e5,1e6,1e7", 1e-3, 1e8, MAX_VALUES,
     "background photons per pixel of the first panel"},
    {"photons-2", "1e2,1e3,1e4,1e5,1e6", 1e-3, 1e8, MAX_VALUES, "of the second"},
    {"photons-3", "3,10,1e2,1e3,1e4", 1e-3, 1e8, MAX_VALUES, "of the third"},
    {"reach", "0.04", 1e-4, 0.5, 1, "largest component of the five shears"},
    {0}};

static const parameter_values *exposures(const options *o, int panel) {
    static const char *const names[N_PANELS] = {"photons-1", "photons-2", "photons-3"};
    return options_list(o, names[panel]);
}

static int64_t stamps(const options *o) {
    int points = N_PANELS; /* the references */
    for (int panel = 0; panel < N_PANELS; panel++)
        points += exposures(o, panel)->n;
    if (options_list(o, "snrs")->n != N_PANELS)
        must_fail(SHEAR_E_SETTING, NULL, "option '--snrs': %d are needed", N_PANELS);
    return o->galaxies * points * N_SHEARS;
}

/* ---- measuring ---- */

/* The ways to measure: the paper's, and two without interpolation. */
static const struct {
    const char *name;
    enum shear_interpolation interpolation;
    const char *shot_noise;
} ways[N_WAYS] = {{"log-spline", SHEAR_INTERP_LOG_SPLINE, "none"},
                  {"none", SHEAR_INTERP_NONE, "none"},
                  {"plateau", SHEAR_INTERP_NONE, "plateau"}};

/* Return g of the shear (g, g): reach, reach/2, 0, -reach/2, -reach. */
static double shear_at(const options *o, int i) {
    return options_number(o, "reach") * (1.0 - 0.5 * i);
}

/* Return a series. `background` is a constant that is not in the images, but is added before their
 * logarithms. */
static series series_of(const options *o, int i_scene, int way, double background) {
    series s = {.scene = i_scene,
                .psf_oversample = psf_oversample(PSF_FINE, o->mock.r_psf_px),
                .settings = o->settings};
    s.settings.interpolation = ways[way].interpolation;
    if (shear_interpolation_is_log(ways[way].interpolation))
        s.settings.pedestal += background;
    must(shear_settings_set(&s.settings, "shot-noise", ways[way].shot_noise, &must_error));
    return s;
}

/* Return the background of a galaxy whose points have amplitude 1. */
static double background_at(const shear_mock_spec *spec, double snr) {
    CLEANUP(shear_mock_release) shear_mock *mock = sampler_mock(spec, 1);
    const shear_mock_info *info = shear_mock_get_info(mock);
    const double area = M_PI * spec->r_gal_px * spec->r_gal_px;
    return info->max_points * info->psf_flux / area / snr;
}

/* Measure. The series are way + N_WAYS * shear. photons = 0 is an infinite exposure. */
static void measure(const options *o, cache *c, double snr, double photons, jackknife_sums *sums) {
    sample s = {.n_scenes = N_SHEARS, .n_series = N_SHEARS * N_WAYS};
    const double background = photons > 0.0 ? 0.0 : background_at(&o->mock, snr);
    for (int i = 0; i < N_SHEARS; i++) {
        shear_mock_spec *m = &s.scenes[i].spec;
        *m = o->mock;
        m->g1 = m->g2 = shear_at(o, i);
        m->photons = photons;
        m->photon_snr = snr;
    }
    for (int i = 0; i < s.n_series; i++)
        s.series[i] = series_of(o, i / N_WAYS, i % N_WAYS, background);
    snprintf(s.name, sizeof s.name, photons > 0.0 ? "snr=%g,photons=%g" : "snr=%g,endless", snr,
             photons);
    sample_measure(o, c, &s, sums);
}

static shear_set set_of(const options *o, int first) {
    shear_set set = {.n = N_SHEARS};
    for (int i = 0; i < N_SHEARS; i++) {
        set.series[i] = first + N_WAYS * i;
        set.g[i][0] = set.g[i][1] = shear_at(o, i);
    }
    return set;
}

/* ---- table ---- */

static const column columns[] = {
    {"snr", TABLE_NUMBER, 2, .help = "mean surface brightness, galaxy over background"},
    {"photons", TABLE_NUMBER, -3, .help = "mean background photons per pixel"},
    {"way", TABLE_TEXT, 0, .help = "log-spline (the paper's); none; none with shot_noise=plateau"},
    {"m#", TABLE_NUMBER, 5, .help = "multiplicative bias", .with_error = true},
    {"dm#", TABLE_NUMBER, 5, .help = "m minus that of the same galaxies in an endless exposure",
     .with_error = true},
    {"c#", TABLE_NUMBER, 5, .help = "additive bias", .with_error = true},
    {0}};

typedef struct outcome {
    curve m[N_PANELS][N_WAYS][2], c[N_PANELS][N_WAYS][2];
    /* exposure from which photon counting does not matter, in photons; NaN: none */
    double from[N_PANELS][N_WAYS];
} outcome;

/* Add a row. The effect of photon counting on m is small if it is below m's own error, or not
 * significant. The series of the infinite exposure come before those of point k = 0. */
static void add_row(run *r, const jackknife_sums *sums, int panel, int k, int way, outcome *out) {
    const shear_set set = set_of(r->options, way + (k + 1) * N_SHEARS * N_WAYS);
    const shear_set endless = set_of(r->options, way);
    const double photons = exposures(r->options, panel)->v[k];
    const bias_fit b = bias_fit_lines(sums, &set);
    double *from = &out->from[panel][way];
    double dm[2];
    double dm_err[2];
    bool small = true;
    bias_fit_compare(sums, &set, &endless, dm, dm_err);
    table_numbers(r->table, options_list(r->options, "snrs")->v[panel], photons);
    table_texts(r->table, ways[way].name);
    for (int c = 0; c < 2; c++) {
        table_numbers(r->table, b.m[c], b.m_err[c], dm[c], dm_err[c], b.c[c], b.c_err[c]);
        curve_add(&out->m[panel][way][c], photons, b.m[c], b.m_err[c]);
        curve_add(&out->c[panel][way][c], photons, b.c[c], b.c_err[c]);
        small = small && fabs(dm[c]) <= fmax(b.m_err[c], 2.0 * dm_err[c]);
    }
    if (!small) {
        *from = NAN;
    } else if (isnan(*from)) {
        *from = photons;
    }
}

static void do_panel(run *r, int panel, outcome *out) {
    const parameter_values *photons = exposures(r->options, panel);
    const double snr = options_list(r->options, "snrs")->v[panel];
    for (int way = 0; way < N_WAYS; way++)
        out->from[panel][way] = NAN;
    CLEANUP(jackknife_sums_deinit) jackknife_sums sums = {0};
    measure(r->options, r->cache, snr, 0.0, &sums);
    for (int k = 0; k < photons->n; k++) {
        measure(r->options, r->cache, snr, photons->v[k], &sums);
        for (int way = 0; way < N_WAYS; way++)
            add_row(r, &sums, panel, k, way, out);
    }
}

static void conclude(run *r, const outcome *out, int panel) {
    char text[N_WAYS][40];
    for (int way = 0; way < N_WAYS; way++) {
        const double from = out->from[panel][way];
        snprintf(text[way], sizeof text[way], isnan(from) ? "at no exposure" : "from %g on", from);
    }
    table_meta(
        r->table, TABLE_CONCLUSION,
        "signal-to-noise %g: photon counting changes m by less than its error %s (Log-Spline), "
        "%s (no interpolation), %s (plateau) photons per pixel",
        options_list(r->options, "snrs")->v[panel], text[0], text[1], text[2]);
}

/* ---- figure ---- */

/* Draw a panel: log-spline as discs, the plateau correction as circles. The third way is only in
 * the table. */
static void draw_panel(const panels *p, int i, double snr, const outcome *out) {
    static const char *const labels[] = {"g_{1}, Log-Spline", "g_{2}, Log-Spline", "g_{1}, plateau",
                                         "g_{2}, plateau"};
    const int panel = i / 2;
    const bool of_c = i % 2 == 1;
    curve curves[4];
    char title[80];
    for (int k = 0; k < 4; k++) {
        curves[k] = (of_c ? out->c : out->m)[panel][k < 2 ? 0 : N_WAYS - 1][k % 2];
        curves[k].hue = k % 2 != 0 ? SHEAR_BLUE : SHEAR_VERMILION;
        curves[k].marker = k < 2 ? SHEAR_DISC : SHEAR_CIRCLE;
        curves[k].label = i == 0 ? labels[k] : NULL;
    }
    snprintf(title, sizeof title, "signal-to-noise %g", snr);
    panels_draw(p, i,
                &(chart){title, panel + 1 == N_PANELS ? "background photons per pixel" : NULL,
                         of_c ? "c" : "m", .log_x = true, .legend = SHEAR_TOP_RIGHT, .truth = 0.0,
                         .spread = 0.015, .n_curves = 4, .curves = curves});
}

static void run_shot(run *r) {
    static outcome out;
    table_columns(r->table, columns);
    for (int panel = 0; panel < N_PANELS; panel++)
        do_panel(r, panel, &out);
    const panels p = run_panels(
        r, NULL, 940, 780, (shear_grid){.rows = N_PANELS, .columns = 2, .gap_x = 10, .gap_y = 4});
    for (int panel = 0; panel < N_PANELS; panel++)
        conclude(r, &out, panel);
    for (int i = 0; i < 2 * N_PANELS; i++)
        draw_panel(&p, i, options_list(r->options, "snrs")->v[i / 2], &out);
}

const experiment experiment_shot = {
    "shot",
    "discussion: m and c under photon counting, against the exposure",
    "Irregular galaxies of R_G = 7.5 R_PSF, R_PSF = 1 pixel, counted photon by photon over a\n"
    "background; the same galaxies for five shears and all exposures. Measured with\n"
    "Log-Spline (the paper's way), without interpolation, and without interpolation but with\n"
    "shot-noise=plateau, which the paper did not have.",
    .defaults = "rotate=1 galaxy=irregular r-psf=1 r-gal=7.5 step-size=0.5625 size=40 filter=none",
    .fixed = "shear photons photon-snr noise-ratio white interpolation shot-noise shot_noise",
    .parameters = parameters,
    .stamps = stamps,
    .run = run_shot};
