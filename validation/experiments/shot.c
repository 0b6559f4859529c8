/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The paper's discussion: m and c under photon counting, against the exposure. */
#include "engine/bias_fit.h"
#include "engine/experiment.h"
#include "engine/methods.h"
#include "engine/must.h"
#include "report/chart.h"
#include "report/run.h"

#include <math.h>
#include <stdlib.h>

enum { N_PANELS = 3, N_SHEARS = 5, N_WAYS = 3 };

static const struct knob knobs[] = {
    {"snrs", "0.01,0.1,1", 1e-6, 1e4, true,
     "mean surface brightness, galaxy over background: the three panels"},
    {"photons-1", "1e3,1e4,1e5,1e6,1e7", 1e-3, 1e8, true,
     "background photons per pixel of the first panel"},
    {"photons-2", "1e2,1e3,1e4,1e5,1e6", 1e-3, 1e8, true, "of the second"},
    {"photons-3", "3,10,1e2,1e3,1e4", 1e-3, 1e8, true, "of the third"},
    {"reach", "0.04", 1e-4, 0.5, false, "largest component of the five shears"},
    {0}};

static const char *const fixed[] = {"shear",       "photons",    "photon-snr",
                                    "noise-ratio", "white",      "interpolation",
                                    "shot-noise",  "shot_noise", NULL};

static void defaults(struct request *r) {
    shear_mock_spec *m = &r->mock;
    m->rotate = 1;
    m->galaxy = SHEAR_MOCK_IRREGULAR;
    m->r_psf_px = 1.0;
    m->r_gal_px = 7.5;
    m->step_px = 0.5625;
    m->nx = m->ny = 40;
    r->settings.filter = SHEAR_FILTER_NONE;
}

/* How a stamp is measured: the paper's way, and two without interpolation. */
static const struct {
    const char *name;
    enum shear_interpolation interpolation;
    const char *shot_noise;
} ways[N_WAYS] = {{"log-spline", SHEAR_INTERP_LOG_SPLINE, "none"},
                  {"none", SHEAR_INTERP_NONE, "none"},
                  {"plateau", SHEAR_INTERP_NONE, "plateau"}};

static const knob_values *exposures(const struct request *r, int panel) {
    static const char *const names[N_PANELS] = {"photons-1", "photons-2", "photons-3"};
    return request_list(r, names[panel]);
}

/* (g, g) for g = reach, reach/2, 0, -reach/2, -reach. */
static double shear_at(const struct request *r, int i) {
    return request_number(r, "reach") * (1.0 - 0.5 * i);
}

/* `background` is a constant that the images do not have, but that their logarithms are to feel. */
static int fill_series(const struct request *r, int scene, double background, struct series *series,
                       shear_error *err) {
    int code = SHEAR_OK;
    for (int i = 0; code == SHEAR_OK && i < N_WAYS; i++) {
        series[i] = (struct series){.scene = scene,
                                    .psf_oversample = psf_oversample(PSF_FINE, r->mock.r_psf_px),
                                    .settings = r->settings};
        series[i].settings.interpolation = ways[i].interpolation;
        if (shear_interpolation_is_log(ways[i].interpolation)) {
            series[i].settings.pedestal += background;
        }
        code = shear_settings_set(&series[i].settings, "shot-noise", ways[i].shot_noise, err);
    }
    return code;
}

/* The background of a galaxy whose points have amplitude 1. */
static int background_at(const shear_mock_spec *spec, double snr, double *background,
                         shear_error *err) {
    shear_mock *mock = NULL;
    int code = shear_mock_new(&mock, spec, err);
    if (code == SHEAR_OK) {
        const shear_mock_info *info = shear_mock_get_info(mock);
        double area = M_PI * spec->r_gal_px * spec->r_gal_px;
        *background = info->max_points * info->psf_flux / area / snr;
        shear_mock_free(mock);
    }
    return code;
}

/* Series: way + N_WAYS * shear. Without photons: what an endless exposure would give. */
static int measure(const struct request *r, struct ledger *ledger, double snr, double photons,
                   struct tally **tally, shear_error *err) {
    char name[64];
    struct scene scenes[N_SHEARS];
    struct series series[N_SHEARS * N_WAYS];
    double background = 0.0;
    int code = photons > 0.0 ? SHEAR_OK : background_at(&r->mock, snr, &background, err);
    for (int i = 0; code == SHEAR_OK && i < N_SHEARS; i++) {
        scenes[i] = (struct scene){.spec = r->mock};
        scenes[i].spec.g1 = scenes[i].spec.g2 = shear_at(r, i);
        scenes[i].spec.photons = photons;
        scenes[i].spec.photon_snr = snr;
        code = fill_series(r, i, background, series + i * N_WAYS, err);
    }
    snprintf(name, sizeof name, photons > 0.0 ? "snr=%g,photons=%g" : "snr=%g,endless", snr,
             photons);
    const sample_spec spec = {.name = name,
                              .stamps = r->galaxies,
                              .groups = r->groups,
                              .threads = r->threads,
                              .n_scenes = N_SHEARS,
                              .scenes = scenes,
                              .n_series = N_SHEARS * N_WAYS,
                              .series = series};
    return code != SHEAR_OK ? code : sample_measure(&spec, ledger, tally, err);
}

static shear_set set_of(const struct request *r, int first) {
    shear_set set = {.n = N_SHEARS};
    for (int i = 0; i < N_SHEARS; i++) {
        set.series[i] = first + N_WAYS * i;
        set.g[i][0] = set.g[i][1] = shear_at(r, i);
    }
    return set;
}

/* m and c, and how far m is from that of the same galaxies in an endless exposure. */
struct result {
    struct bias bias;
    double dm[2], dm_err[2];
};

/* The reference's series stand behind the point's. */
static int fit(const struct request *r, const struct tally *tally, int way, struct result *out,
               shear_error *err) {
    const shear_set set = set_of(r, way);
    const shear_set reference = set_of(r, way + N_SHEARS * N_WAYS);
    int code = bias_fit(tally, &set, &out->bias, err);
    return code != SHEAR_OK ? code
                            : bias_compare(tally, &set, &reference, out->dm, out->dm_err, err);
}

/* ---- table ---- */

static void add_columns(struct table *t) {
    table_column(t, "snr", TABLE_NUMBER, 2, "", "mean surface brightness, galaxy over background");
    table_column(t, "photons", TABLE_NUMBER, -3, "", "mean background photons per pixel");
    table_column(t, "way", TABLE_TEXT, 0, "",
                 "log-spline (the paper's); none; none with shot_noise=plateau");
    for (int c = 1; c <= 2; c++) {
        char name[24];
        snprintf(name, sizeof name, "m%d", c);
        table_column(t, name, TABLE_NUMBER, 5, "", "multiplicative bias");
        snprintf(name, sizeof name, "m%d_err", c);
        table_column(t, name, TABLE_NUMBER, 5, "", "its 1-sigma error");
        snprintf(name, sizeof name, "dm%d", c);
        table_column(t, name, TABLE_NUMBER, 5, "",
                     "m minus that of the same galaxies in an endless exposure");
        snprintf(name, sizeof name, "dm%d_err", c);
        table_column(t, name, TABLE_NUMBER, 5, "", "its 1-sigma error");
        snprintf(name, sizeof name, "c%d", c);
        table_column(t, name, TABLE_NUMBER, 5, "", "additive bias");
        snprintf(name, sizeof name, "c%d_err", c);
        table_column(t, name, TABLE_NUMBER, 5, "", "its 1-sigma error");
    }
}

static void add_row(struct table *t, double snr, double photons, int way, const struct result *x) {
    const struct bias *b = &x->bias;
    table_number(t, snr);
    table_number(t, photons);
    table_text(t, ways[way].name);
    for (int c = 0; c < 2; c++) {
        table_number(t, b->m[c]);
        table_number(t, b->m_err[c]);
        table_number(t, x->dm[c]);
        table_number(t, x->dm_err[c]);
        table_number(t, b->c[c]);
        table_number(t, b->c_err[c]);
    }
}

/* ---- the exposure from which on photon counting does not matter ---- */

struct outcome {
    struct curve m[N_PANELS][N_WAYS][2], c[N_PANELS][N_WAYS][2];
    double from[N_PANELS][N_WAYS]; /* photons; NaN: from none on */
};

/* What counting photons adds to m is small where it is below m's own error, or not seen at all. */
static void take(struct outcome *o, int panel, int way, double photons, const struct result *x) {
    const struct bias *b = &x->bias;
    bool small = true;
    for (int c = 0; c < 2; c++) {
        curve_add(&o->m[panel][way][c], photons, b->m[c], b->m_err[c]);
        curve_add(&o->c[panel][way][c], photons, b->c[c], b->c_err[c]);
        small = small && fabs(x->dm[c]) <= fmax(b->m_err[c], 2.0 * x->dm_err[c]);
    }
    if (!small) {
        o->from[panel][way] = NAN;
    } else if (isnan(o->from[panel][way])) {
        o->from[panel][way] = photons;
    }
}

static void judge(const struct request *r, struct table *t, const struct outcome *o) {
    for (int panel = 0; panel < N_PANELS; panel++) {
        char text[N_WAYS][40];
        for (int way = 0; way < N_WAYS; way++) {
            double from = o->from[panel][way];
            snprintf(text[way], sizeof text[way], isnan(from) ? "at no exposure" : "from %g on",
                     from);
        }
        table_meta(
            t, "verdict",
            "signal-to-noise %g: photon counting changes m by less than its error %s (Log-Spline), "
            "%s (no interpolation), %s (plateau) photons per pixel",
            request_list(r, "snrs")->v[panel], text[0], text[1], text[2]);
    }
}

/* ---- figure ---- */

/* Log-spline as discs, the plateau as circles; the way between is in the table. */
static void draw_panel(const struct request *r, struct outcome *o, shear_figure *f, shear_rect cell,
                       int panel, bool of_c) {
    struct curve curves[4];
    char title[80];
    static const char *const labels[] = {"g_{1}, Log-Spline", "g_{2}, Log-Spline", "g_{1}, plateau",
                                         "g_{2}, plateau"};
    for (int i = 0; i < 4; i++) {
        curves[i] = (of_c ? o->c : o->m)[panel][i < 2 ? 0 : N_WAYS - 1][i % 2];
        curves[i].hue = i % 2 ? SHEAR_BLUE : SHEAR_VERMILION;
        curves[i].marker = i < 2 ? SHEAR_DISC : SHEAR_CIRCLE;
        curves[i].label = panel == 0 && !of_c ? labels[i] : NULL;
    }
    snprintf(title, sizeof title, "signal-to-noise %g", request_list(r, "snrs")->v[panel]);
    chart_draw(
        f, &(struct chart){.cell = cell,
                           .title = title,
                           .x_label = panel + 1 == N_PANELS ? "background photons per pixel" : NULL,
                           .y_label = of_c ? "c" : "m",
                           .log_x = true,
                           .legend = SHEAR_TOP_RIGHT,
                           .truth = 0.0,
                           .spread = 0.015,
                           .n_curves = 4,
                           .curves = curves});
}

static int draw(const struct request *r, struct outcome *o, shear_figure **f, shear_error *err) {
    int code = shear_figure_new(f, 940, 780, err);
    const shear_grid grid = {
        .area = {8, 8, 924, 764}, .rows = N_PANELS, .columns = 2, .gap_x = 10, .gap_y = 4};
    for (int i = 0; code == SHEAR_OK && i < 2 * N_PANELS; i++) {
        draw_panel(r, o, *f, shear_grid_cell(&grid, i / 2, i % 2, 1, 1), i / 2, i % 2 == 1);
    }
    return code;
}

/* ---- all ---- */

static int do_point(const struct request *r, struct ledger *ledger, const struct tally *reference,
                    int panel, double photons, struct table *t, struct outcome *o,
                    shear_error *err) {
    double snr = request_list(r, "snrs")->v[panel];
    struct tally *tally = NULL;
    int code = measure(r, ledger, snr, photons, &tally, err);
    code = code != SHEAR_OK ? code : tally_append(tally, reference, err);
    for (int way = 0; code == SHEAR_OK && way < N_WAYS; way++) {
        struct result x;
        code = fit(r, tally, way, &x, err);
        if (code == SHEAR_OK) {
            add_row(t, snr, photons, way, &x);
            take(o, panel, way, photons, &x);
        }
    }
    tally_free(tally);
    return code;
}

static int do_points(const struct request *r, struct ledger *ledger, struct table *t,
                     struct outcome *o, shear_error *err) {
    int code = SHEAR_OK;
    for (int panel = 0; code == SHEAR_OK && panel < N_PANELS; panel++) {
        const knob_values *photons = exposures(r, panel);
        struct tally *reference = NULL;
        for (int way = 0; way < N_WAYS; way++) {
            o->from[panel][way] = NAN;
        }
        code = measure(r, ledger, request_list(r, "snrs")->v[panel], 0.0, &reference, err);
        for (int k = 0; code == SHEAR_OK && k < photons->n; k++) {
            code = do_point(r, ledger, reference, panel, photons->v[k], t, o, err);
        }
        tally_free(reference);
    }
    return code;
}

static int open_ledger(const struct request *r, struct ledger **ledger, shear_error *err) {
    int points = N_PANELS; /* the references */
    for (int panel = 0; panel < N_PANELS; panel++) {
        points += exposures(r, panel)->n;
    }
    if (request_list(r, "snrs")->n != N_PANELS) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "option '--snrs': %d are needed", N_PANELS);
    }
    return ledger_open(ledger, r, r->galaxies * points * N_SHEARS, err);
}

static int exec(const struct request *r, shear_error *err) {
    struct ledger *ledger = NULL;
    shear_figure *f = NULL;
    struct table *t = table_new(r);
    int code = open_ledger(r, &ledger, err);
    struct outcome *o = memory_new(1, sizeof *o, "results", &code, err);
    add_columns(t);
    code = code != SHEAR_OK ? code : do_points(r, ledger, t, o, err);
    if (code == SHEAR_OK) {
        judge(r, t, o);
        code = draw(r, o, &f, err);
    }
    code = code != SHEAR_OK ? code : report_save(r, ledger, t, f, err);
    shear_figure_free(f);
    table_free(t);
    free(o);
    ledger_close(ledger);
    return code;
}

const experiment exp_shot = {
    .name = "shot",
    .summary = "discussion: m and c under photon counting, against the exposure",
    .about =
        "Irregular galaxies of R_G = 7.5 R_PSF, R_PSF = 1 pixel, counted photon by photon over a\n"
        "background; the same galaxies for five shears and all exposures. Measured with "
        "Log-Spline\n"
        "(the paper's way), without interpolation, and without interpolation but with\n"
        "shot-noise=plateau, which the paper did not have.",
    .knobs = knobs,
    .fixed = fixed,
    .defaults = defaults,
    .exec = exec,
};
