/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beyond the paper: under-sampled data, and why they need no logarithm. */
#include "experiments/narrow.h"
#include "engine/aliases.h"
#include "engine/experiment.h"
#include "engine/methods.h"
#include "engine/must.h"

#include <math.h>
#include <stdlib.h>

enum {
    SIGNS = 2,
    SERIES = SIGNS * NARROW_WAYS, /* series 2 sign + way */
    POWERS = 480,
    POWER_GALAXIES = 32,
    POWER_ANGLES = 8
};
const char *const narrow_ways[NARROW_WAYS] = {"defaults", "zhang2010"};
const double narrow_disks_px[NARROW_DISKS] = {0.0, 0.5, 1.0, 2.0};
static const double power_step = 0.05; /* of k, per px */

static const struct knob knobs[] = {
    {"radii", "0.3,0.35,0.4,0.45,0.5,0.6,0.7,0.8,0.9,1,1.2", 0.2, 4, true, "R_PSF, pixels"}, {0}};

static const char *const fixed[] = {"size",     "galaxy",      "psf",           "r-psf",
                                    "oversamp", "noise-ratio", "white",         "photons",
                                    "preset",   "psf-size",    "psf-angle",     "beta",
                                    "filter",   "psf-ids",     "interpolation", NULL};

static void defaults(struct request *r) {
    (void)shear_settings_set(&r->settings, "preset", "default", NULL);
    r->settings.filter = SHEAR_FILTER_NONE;
    r->mock.g1 = 0.03;
    r->mock.g2 = -0.02;
    r->mock.rotate = 4;
    r->mock.galaxy = SHEAR_MOCK_IRREGULAR;
    r->galaxies = 3200;
    r->groups = 50;
}

/* ---- the aliases ---- */

/* |f|^2 of the mocks' own galaxies, averaged over directions and some of them, in steps of k. */
struct powers {
    double v[POWERS];
};

static double power_at(double k, const void *context) {
    const struct powers *p = context;
    const double at = fmin(k / power_step, POWERS - 1.001);
    const int i = (int)at;
    return p->v[i] + (at - i) * (p->v[i + 1] - p->v[i]);
}

static double power_of_points(int n, const double *x, const double *y, double k) {
    double sum = 0.0;
    for (int a = 0; a < POWER_ANGLES; a++) {
        const double kx = k * cos(M_PI * a / POWER_ANGLES);
        const double ky = k * sin(M_PI * a / POWER_ANGLES);
        double re = 0.0;
        double im = 0.0;
        for (int i = 0; i < n; i++) {
            re += cos(kx * x[i] + ky * y[i]);
            im += sin(kx * x[i] + ky * y[i]);
        }
        sum += re * re + im * im;
    }
    return sum / POWER_ANGLES;
}

static int find_powers(const struct request *r, struct powers *p, shear_error *err) {
    shear_mock_spec spec = r->mock;
    shear_mock *mock = NULL;
    int code = SHEAR_OK;
    spec.n_stamps = (int64_t)POWER_GALAXIES * spec.rotate;
    code = shear_mock_new(&mock, &spec, err);
    const int most = code != SHEAR_OK ? 0 : shear_mock_get_info(mock)->max_points;
    double *x = memory_new(2 * (size_t)most, sizeof *x, "points", &code, err);
    *p = (struct powers){0};
    for (int galaxy = 0; code == SHEAR_OK && galaxy < POWER_GALAXIES; galaxy++) {
        const int n = shear_mock_points(mock, galaxy, x, x + most);
#pragma omp parallel for schedule(dynamic)
        for (int i = 0; i < POWERS; i++) {
            p->v[i] += power_of_points(n, x, x + most, power_step * i);
        }
    }
    free(x);
    shear_mock_free(mock);
    return code;
}

/* W_A is longer along y, eq. (Ws). */
static double share_at(double r_psf_px, double beta_px, power_function *power,
                       const void *context) {
    const double sigma_px[] = {r_psf_px, r_psf_px / sqrt(0.8)};
    return aliases_share(beta_px, sigma_px, power, context);
}

/* ---- measuring ---- */

static int settings_of(const struct request *r, double r_psf_px, shear_settings ways[NARROW_WAYS],
                       shear_error *err) {
    ways[0] = ways[1] = r->settings;
    ways[0].interpolation = SHEAR_INTERP_NONE;
    const int code = shear_settings_set(&ways[1], "preset", narrow_ways[1], err);
    ways[1].filter = SHEAR_FILTER_NONE;
    for (int i = 0; i < NARROW_WAYS; i++) {
        ways[i].beta_px = fmax(ways[i].beta_ratio * r_psf_px, ways[i].beta_floor_px);
    }
    return code;
}

static int measure(const struct request *r, struct ledger *ledger, narrow_point *p,
                   shear_error *err) {
    struct scene scenes[SIGNS];
    struct series series[SERIES];
    shear_settings ways[NARROW_WAYS];
    struct tally *tally = NULL;
    char name[32];
    int code = settings_of(r, p->r_psf_px, ways, err);
    for (int i = 0; i < SERIES; i++) {
        struct scene *s = &scenes[i / NARROW_WAYS];
        *s = (struct scene){.spec = r->mock};
        s->spec.g1 *= i / NARROW_WAYS ? -1.0 : 1.0;
        s->spec.g2 *= i / NARROW_WAYS ? -1.0 : 1.0;
        s->spec.r_psf_px = p->r_psf_px;
        s->spec.nx = s->spec.ny = stamp_side(s->spec.r_gal_px, p->r_psf_px);
        series[i] = (struct series){.scene = i / NARROW_WAYS,
                                    .psf_oversample = psf_oversample(PSF_FINE, p->r_psf_px),
                                    .settings = ways[i % NARROW_WAYS]};
        p->beta_px[i % NARROW_WAYS] = ways[i % NARROW_WAYS].beta_px;
    }
    snprintf(name, sizeof name, "R_PSF=%g", p->r_psf_px);
    const sample_spec spec = {.name = name,
                              .stamps = r->galaxies,
                              .groups = r->groups,
                              .threads = r->threads,
                              .n_scenes = SIGNS,
                              .scenes = scenes,
                              .n_series = SERIES,
                              .series = series};
    code = code != SHEAR_OK ? code : sample_measure(&spec, ledger, &tally, err);
    for (int way = 0; code == SHEAR_OK && way < NARROW_WAYS; way++) {
        const shear_set set = {.n = SIGNS,
                               .series = {way, NARROW_WAYS + way},
                               .g = {{r->mock.g1, r->mock.g2}, {-r->mock.g1, -r->mock.g2}}};
        code = bias_fit(tally, &set, &p->bias[way], err);
    }
    tally_free(tally);
    return code;
}

static double find_limit(const struct request *r) {
    double lo = 0.1;
    double hi = 1.0;
    for (int i = 0; i < 30; i++) {
        const double middle = 0.5 * (lo + hi);
        const double beta = fmax(r->settings.beta_ratio * middle, r->settings.beta_floor_px);
        *(share_at(middle, beta, disk_power, &narrow_disks_px[1]) > 1e-3 ? &lo : &hi) = middle;
    }
    return lo;
}

/* ---- all ---- */

static int exec(const struct request *r, shear_error *err) {
    const knob_values *radii = request_list(r, "radii");
    struct ledger *ledger = NULL;
    struct powers powers;
    struct narrow n = {.limit_px = find_limit(r)};
    int code = ledger_open(&ledger, r, SIGNS * r->galaxies * radii->n, err);
    code = code != SHEAR_OK ? code : find_powers(r, &powers, err);
    for (int i = 0; code == SHEAR_OK && i < radii->n; i++) {
        narrow_point *p = &n.points[n.n++];
        p->r_psf_px = radii->v[i];
        code = measure(r, ledger, p, err);
        p->own = share_at(p->r_psf_px, p->beta_px[0], power_at, &powers);
        for (int k = 0; k < NARROW_DISKS; k++) {
            p->disk[k] = share_at(p->r_psf_px, p->beta_px[0], disk_power, &narrow_disks_px[k]);
        }
    }
    code = code != SHEAR_OK ? code : narrow_report(r, ledger, &n, err);
    ledger_close(ledger);
    return code;
}

const experiment exp_narrow = {
    .name = "narrow",
    .summary = "beyond the paper: under-sampled data, R_PSF from 0.3 pixels on",
    .about = "Irregular galaxies in fours at +g and -g, without noise, behind W_A given finely\n"
             "sampled: m and c against R_PSF by the defaults (no interpolation, beta at least\n"
             "1.4 pixels) and by preset zhang2010 (log-bicubic where R_PSF is below 1 pixel).\n"
             "Beside it the part of the signal that aliases have under the target, by\n"
             "quadrature: of these galaxies, of points, and of exponential disks.",
    .knobs = knobs,
    .fixed = fixed,
    .defaults = defaults,
    .exec = exec,
};
