/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beyond the paper: m and c from very many galaxies, and the terms beyond the first order. */
#include "engine/bias_fit.h"
#include "engine/experiment.h"
#include "engine/methods.h"
#include "experiments/bias_report.h"

#include <math.h>
#include <stdlib.h>

static const struct knob knobs[] = {
    {"kinds", "0,1", 0, 1, true, "galaxies: 0 regular, 1 irregular"},
    {"psfs", "0,1", 0, 1, true, "0 W_A, 1 W_B"},
    {"noises", "0,1,2", 0, 2, true, "0 none, 1 white, 2 point sources"},
    {"ways", "0,1", 0, 1, true, "0 without interpolation, 1 Log-Bicubic and Log-Spline"},
    {"reach", "0.02", 1e-4, 0.5, false, "the five shears: 0, and this along both axes and signs"},
    {"large", "0.025,0.05,0.075,0.1", 0, 0.5, true,
     "shears of the test of the higher orders; 0 = leave it out"},
    {"sigma", "0.1", 1e-6, 1e6, false, "white noise per pixel, over the peak of a point"},
    {"ratio", "0.05", 1e-6, 1e6, false, "I_N/I_G of the point sources"},
    {"r-psf-log", "1", 0.1, 10, false, "R_PSF where images are interpolated, pixels"},
    {"fewer", "10", 1, 1e6, false, "slow cases have so many times fewer galaxies"},
    {0}};

static const char *const fixed[] = {"galaxy",  "psf",           "shear",       "white",
                                    "photons", "interpolation", "noise-ratio", NULL};

static void defaults(struct request *r) {
    shear_mock_spec *m = &r->mock;
    m->rotate = 4;
    m->turn_stamps = true;
    m->nx = m->ny = 48;
    m->points = 100;
    m->steps = 100;
    m->r_gal_px = 6.0;
    m->step_px = 1.0;
    m->r_psf_px = 1.5;
    r->settings.filter = SHEAR_FILTER_NONE;
    r->settings.zeros = SHEAR_ZEROS_FLOOR;
    r->galaxies = 1000000;
    r->groups = 200;
}

/* ---- one case ---- */

/* Interpolation costs much, and the point sources of W_B with their long spikes do too. */
static int64_t stamps_of(const struct request *r, const bias_case *b) {
    bool slow = b->way > 0 || b->large || (b->noise == BIAS_SOURCES && b->psf == SHEAR_MOCK_PSF_B);
    double n = (double)r->galaxies / (slow ? request_number(r, "fewer") : 1.0);
    return (int64_t)ceil(n / r->mock.rotate) * r->mock.rotate;
}

static shear_mock_spec spec_of(const struct request *r, const bias_case *b) {
    shear_mock_spec m = r->mock;
    m.galaxy = b->kind;
    m.psf = b->psf;
    m.g1 = m.g2 = 0.0;
    m.white_sigma = b->noise == BIAS_WHITE ? request_number(r, "sigma") : 0.0;
    if (b->way > 0) {
        double scale = request_number(r, "r-psf-log") / m.r_psf_px;
        m.r_psf_px *= scale;
        m.r_gal_px *= scale;
        m.step_px *= scale;
        m.nx = good_side(m.nx * scale);
        m.ny = good_side(m.ny * scale);
        m.noise_ratio = b->noise == BIAS_SOURCES ? request_number(r, "ratio") : 0.0;
    }
    return m;
}

static int n_shears(const struct request *r, const bias_case *b) {
    return b->large ? 4 * request_list(r, "large")->n : 5;
}

/* +g and -g along g1, then along g2, of each size; then no shear. */
static void shear_of(const struct request *r, const bias_case *b, int i, double g[2]) {
    double size = b->large ? request_list(r, "large")->v[i / 4]
                  : i < 4  ? request_number(r, "reach")
                           : 0.0;
    g[0] = g[1] = 0.0;
    g[i % 4 / 2] = i % 2 ? -size : size;
}

/* Series: shear, or 2 shear + method. Without interpolation the noise is drawn once for all shears.
 */
int bias_measure(const struct request *r, struct ledger *ledger, const bias_case *b,
                 struct tally **tally, shear_error *err) {
    struct scene scenes[BIAS_MAX_SHEARS];
    struct series series[2 * BIAS_MAX_SHEARS];
    char name[64];
    shear_mock_spec noise = spec_of(r, b);
    bool shares = b->noise == BIAS_SOURCES && b->way == 0;
    int n = n_shears(r, b);
    int methods_of_way = b->way > 0 ? 2 : 1;
    noise.noise_ratio = request_number(r, "ratio");
    for (int i = 0; i < n; i++) {
        double g[2];
        shear_of(r, b, i, g);
        scenes[i] = (struct scene){.spec = spec_of(r, b), .shared = shares ? 1.0 : 0.0};
        scenes[i].spec.g1 = g[0];
        scenes[i].spec.g2 = g[1];
        for (int k = 0; k < methods_of_way; k++) {
            struct series *s = &series[methods_of_way * i + k];
            *s = method_series(i, N_METHODS - 2 + k, PSF_FINE, noise.r_psf_px, &r->settings);
            if (b->way == 0) {
                s->settings.interpolation = SHEAR_INTERP_NONE;
                s->settings.oversample = r->settings.oversample;
            }
        }
    }
    const sample_spec spec = {.name = bias_case_name(b, name, sizeof name),
                              .stamps = stamps_of(r, b),
                              .groups = r->groups,
                              .threads = r->threads,
                              .n_scenes = n,
                              .scenes = scenes,
                              .n_series = methods_of_way * n,
                              .series = series,
                              .noise = shares ? &noise : NULL,
                              .exchange = true};
    return sample_measure(&spec, ledger, tally, err);
}

shear_set bias_shears(const struct request *r, const bias_case *b, int method) {
    shear_set set = {.n = n_shears(r, b)};
    for (int i = 0; i < set.n; i++) {
        set.series[i] = b->way > 0 ? 2 * i + method : i;
        shear_of(r, b, i, set.g[i]);
    }
    return set;
}

/* ---- all cases ---- */

static bool asks_large(const struct request *r) {
    return request_list(r, "large")->v[0] > 0.0;
}

/* Logarithms and white noise do not go together: some pixels are negative. */
static bool is_sound(const bias_case *b) {
    return !(b->way > 0 && b->noise == BIAS_WHITE) && !(b->large && (b->way > 0 || b->noise > 0));
}

static int list_cases(const struct request *r, bias_case *cases) {
    const knob_values *kinds = request_list(r, "kinds");
    const knob_values *psfs = request_list(r, "psfs");
    const knob_values *noises = request_list(r, "noises");
    const knob_values *ways = request_list(r, "ways");
    int n = 0;
    for (int i = 0; i < 2 * ways->n * noises->n * psfs->n * kinds->n; i++) {
        int rest = i / 2;
        bias_case b = {.large = i % 2 == 1};
        b.noise = (int)noises->v[rest % noises->n];
        rest /= noises->n;
        b.way = (int)ways->v[rest % ways->n];
        rest /= ways->n;
        b.psf = (int)psfs->v[rest % psfs->n];
        b.kind = (int)kinds->v[rest / psfs->n];
        if (is_sound(&b) && n < BIAS_MAX_CASES && (!b.large || asks_large(r))) {
            cases[n++] = b;
        }
    }
    return n;
}

static int exec(const struct request *r, shear_error *err) {
    bias_case cases[BIAS_MAX_CASES];
    struct ledger *ledger = NULL;
    int64_t total = 0;
    int n = list_cases(r, cases);
    for (int i = 0; i < n; i++) {
        total += stamps_of(r, &cases[i]) * n_shears(r, &cases[i]);
    }
    if (4 * request_list(r, "large")->n > BIAS_MAX_SHEARS) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "option '--large': at most %d",
                          BIAS_MAX_SHEARS / 4);
    }
    int code = ledger_open(&ledger, r, total, err);
    code = code != SHEAR_OK ? code : bias_report(r, ledger, cases, n, err);
    ledger_close(ledger);
    return code;
}

const experiment exp_bias = {
    .name = "bias",
    .summary = "beyond the paper: m and c from a million galaxies, and shears up to 0.1",
    .about = "Galaxies in fours (0, 45, 90, 135 degrees; --galaxies counts all stamps), the\n"
             "same at five shears: m and c by kind of galaxy, PSF, interpolation and noise.\n"
             "The stamps at 90 and 135 degrees are those at 0 and 45 turned, noise and all.\n"
             "Without interpolation R_PSF is 1.5 pixels; Log-Bicubic and Log-Spline have R_PSF\n"
             "= 1 pixel. Then, without noise, shears up to 0.1 for the next order: measured -\n"
             "true = m g + a |g|^2 g. Slow cases (interpolation, large shears, point sources\n"
             "under W_B) have a tenth of the galaxies.",
    .knobs = knobs,
    .fixed = fixed,
    .defaults = defaults,
    .exec = exec,
};
