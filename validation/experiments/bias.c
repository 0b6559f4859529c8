/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Experiment `bias` (beyond the paper): m and c from very many galaxies, and terms of higher order.
 */
#include "engine/methods.h"
#include "engine/must.h"
#include "experiments/bias_report.h"
#include "experiments/list.h"

#include <math.h>
#include <stdio.h>

static const parameter parameters[] = {
    {"kinds", "0,1", 0, 1, MAX_VALUES, "galaxies: 0 regular, 1 irregular"},
    {"psfs", "0,1", 0, 1, MAX_VALUES, "0 W_A, 1 W_B"},
    {"noises", "0,1,2", 0, 2, MAX_VALUES, "0 none, 1 white, 2 point sources"},
    {"ways", "0,1", 0, 1, MAX_VALUES, "0 without interpolation, 1 Log-Bicubic and Log-Spline"},
    {"reach", "0.02", 1e-4, 0.5, 1, "the five shears: 0, and this along both axes and signs"},
    {"large", "0.025,0.05,0.075,0.1", 0, 0.5, BIAS_MAX_SHEARS / 4,
     "shears of the test of the higher orders; 0 = leave it out"},
    {"sigma", "0.1", 1e-6, 1e6, 1, "white noise per pixel, over the peak of a point"},
    {"ratio", "0.05", 1e-6, 1e6, 1, "I_N/I_G of the point sources"},
    {"r-psf-log", "1", 0.1, 10, 1, "R_PSF where images are interpolated, pixels"},
    {"fewer", "10", 1, 1e6, 1, "slow cases have so many times fewer galaxies"},
    {0}};

/* ---- the cases ---- */

typedef struct bias_cases {
    int n;
    bias_case of[MAX_CASES];
} bias_cases;

/* Return whether the case is possible: logarithms and white noise are not, because pixels are
 * negative. */
static bool is_sound(const bias_case *b) {
    return !(b->interpolated && b->noise == WHITE) &&
           !(b->large && (b->interpolated || b->noise != CLEAN));
}

static bias_cases list_cases(const options *o) {
    const parameter_values *of_kinds = options_list(o, "kinds");
    const parameter_values *of_psfs = options_list(o, "psfs");
    const parameter_values *of_noises = options_list(o, "noises");
    const parameter_values *of_ways = options_list(o, "ways");
    const bool asks_large = options_list(o, "large")->v[0] > 0.0;
    bias_cases all = {0};
    for (int i = 0; i < 2 * of_ways->n * of_noises->n * of_psfs->n * of_kinds->n; i++) {
        int rest = i / 2;
        bias_case b = {.large = i % 2 == 1};
        b.noise = (enum bias_noise)of_noises->v[rest % of_noises->n];
        rest /= of_noises->n;
        b.interpolated = (int)of_ways->v[rest % of_ways->n] > 0;
        rest /= of_ways->n;
        b.psf = (enum shear_mock_psf)of_psfs->v[rest % of_psfs->n];
        b.kind = (enum shear_mock_galaxy)of_kinds->v[rest / of_psfs->n];
        if (is_sound(&b) && all.n < MAX_CASES && (!b.large || asks_large))
            all.of[all.n++] = b;
    }
    return all;
}

static int n_ways(const bias_case *b) {
    return b->interpolated ? 2 : 1;
}

/* Return the number of stamps: fewer for the slow cases (interpolation, point sources of W_B) and
 * for large shears. */
static int64_t stamps_of(const options *o, const bias_case *b) {
    const bool slow =
        b->interpolated || b->large || (b->noise == SOURCES && b->psf == SHEAR_MOCK_PSF_B);
    const double n = (double)o->galaxies / (slow ? options_number(o, "fewer") : 1.0);
    return (int64_t)ceil(n / o->mock.rotate) * o->mock.rotate;
}

/* Return the shears: +g and -g along g1, then along g2, of each size; then no shear. Without
 * interpolation there is one series per shear, otherwise two. */
static shear_set shears_of(const options *o, const bias_case *b, int way) {
    const parameter_values *large = options_list(o, "large");
    shear_set set = {.n = b->large ? 4 * large->n : 5};
    for (int i = 0; i < set.n; i++) {
        const double small = i < 4 ? options_number(o, "reach") : 0.0;
        const double size = b->large ? large->v[i / 4] : small;
        set.g[i][i % 4 / 2] = i % 2 != 0 ? -size : size;
        set.series[i] = n_ways(b) * i + way;
    }
    return set;
}

static int64_t stamps(const options *o) {
    const bias_cases all = list_cases(o);
    int64_t total = 0;
    for (int i = 0; i < all.n; i++)
        total += stamps_of(o, &all.of[i]) * shears_of(o, &all.of[i], 0).n;
    return total;
}

/* ---- measuring ---- */

static shear_mock_spec spec_of(const options *o, const bias_case *b) {
    shear_mock_spec m = o->mock;
    m.galaxy = b->kind;
    m.psf = b->psf;
    m.g1 = m.g2 = 0.0;
    m.white_sigma = b->noise == WHITE ? options_number(o, "sigma") : 0.0;
    if (b->interpolated) {
        const double scale = options_number(o, "r-psf-log") / m.r_psf_px;
        m.r_psf_px *= scale;
        m.r_gal_px *= scale;
        m.step_px *= scale;
        m.nx = good_side(m.nx * scale);
        m.ny = good_side(m.ny * scale);
        m.noise_ratio = b->noise == SOURCES ? options_number(o, "ratio") : 0.0;
    }
    return m;
}

/* Measure a case. Without interpolation the noise is drawn once for all shears. */
static void measure(const options *o, cache *c, const bias_case *b, jackknife_sums *sums) {
    const shear_set set = shears_of(o, b, 0);
    const bool shares = b->noise == SOURCES && !b->interpolated;
    shear_mock_spec noise = spec_of(o, b);
    sample s = {.stamps = stamps_of(o, b),
                .n_scenes = set.n,
                .n_series = n_ways(b) * set.n,
                .noise = shares ? &noise : NULL,
                .exchange = true};
    noise.noise_ratio = options_number(o, "ratio");
    for (int i = 0; i < set.n; i++) {
        s.scenes[i] = (scene){.spec = spec_of(o, b), .shared = shares ? 1.0 : 0.0};
        s.scenes[i].spec.g1 = set.g[i][0];
        s.scenes[i].spec.g2 = set.g[i][1];
    }
    for (int i = 0; i < s.n_series; i++) {
        const int which = N_METHODS - 2 + i % n_ways(b);
        s.series[i] = method_series(which, PSF_FINE, noise.r_psf_px, &o->settings);
        s.series[i].scene = i / n_ways(b);
        if (!b->interpolated) {
            s.series[i].settings.interpolation = SHEAR_INTERP_NONE;
            s.series[i].settings.oversample = o->settings.oversample;
        }
    }
    snprintf(s.name, sizeof s.name, "%s,W_%s,noise=%s%s%s", bias_kinds[b->kind], bias_psfs[b->psf],
             bias_noises[b->noise], b->interpolated ? ",log" : "", b->large ? ",large" : "");
    sample_measure(o, c, &s, sums);
}

/* Compute half the difference between +g and -g, over g: the odd part in the shear, averaged over
 * both axes. */
static void relative(const jackknife_total *totals, const void *context, double *out) {
    const shear_set *set = context;
    for (int k = 0; k < set->n / 4; k++) {
        const jackknife_total *along1 = &totals[set->series[4 * k]];
        const jackknife_total *along2 = &totals[set->series[4 * k + 2]];
        const double g1 = 0.5 * (along1[0].g[0] - along1[1].g[0]);
        const double g2 = 0.5 * (along2[0].g[1] - along2[1].g[1]);
        out[k] = 0.5 * (g1 + g2) / set->g[4 * k][0] - 1.0;
    }
}

static void add_large_curve(lines *all, const bias_case *b, const jackknife_sums *sums,
                            const shear_set *set) {
    enum { MOST = BIAS_MAX_SHEARS / 4 };
    double v[MOST];
    double cov[MOST * MOST];
    const int n = set->n / 4;
    jackknife_covariance(sums, relative, set, n, v, cov);
    if (all->n_large == MAX_LARGE)
        return;
    char *label = all->large_label[all->n_large];
    curve *c = &all->large[all->n_large++];
    *c = (curve){label, (enum shear_hue)all->n_large,
                 .marker = (enum shear_marker)((all->n_large - 1) % 4)};
    for (int k = 0; k < n; k++)
        curve_add(c, set->g[4 * k][0], v[k], sqrt(cov[k * n + k]));
    snprintf(label, sizeof all->large_label[0], "%s W_{%s}", bias_kinds[b->kind],
             bias_psfs[b->psf]);
}

static void do_case(run *r, const bias_case *b, lines *all) {
    CLEANUP(jackknife_sums_deinit) jackknife_sums sums = {0};
    measure(r->options, r->cache, b, &sums);
    for (int k = 0; k < n_ways(b); k++) {
        const shear_set set = shears_of(r->options, b, k);
        line *l = &all->of[all->n++];
        *l = (line){.of = *b, .way = b->interpolated ? 1 + k : 0};
        for (int group = 0; group < sums.groups; group++)
            l->n += (double)jackknife_sums_at(&sums, set.series[0], group)->n_used;
        if (b->large) {
            l->cubic = bias_fit_cubic(&sums, &set);
            add_large_curve(all, b, &sums, &set);
        } else {
            l->bias = bias_fit_lines(&sums, &set);
        }
    }
}

static void run_bias(run *r) {
    const bias_cases cases = list_cases(r->options);
    static lines all;
    for (int i = 0; i < cases.n; i++)
        do_case(r, &cases.of[i], &all);
    bias_report(r, &all);
}

const experiment experiment_bias = {
    "bias",
    "beyond the paper: m and c from a million galaxies, and shears up to 0.1",
    "Galaxies in fours (0, 45, 90, 135 degrees; --galaxies counts all stamps), the same at\n"
    "five shears: m and c by kind of galaxy, PSF, interpolation and noise. The stamps at 90\n"
    "and 135 degrees are those at 0 and 45 turned, noise and all. Without interpolation R_PSF\n"
    "is 1.5 pixels; Log-Bicubic and Log-Spline have R_PSF = 1 pixel. Then, without noise,\n"
    "shears up to 0.1 for the next order: measured - true = m g + a |g|^2 g. Slow cases\n"
    "(interpolation, large shears, point sources under W_B) have a tenth of the galaxies.",
    .defaults = "rotate=4 turn-stamps=yes size=48 points=100 steps=100 r-gal=6 step-size=1 "
                "r-psf=1.5 filter=none zeros=floor galaxies=1000000 groups=200",
    .fixed = "galaxy psf shear white photons interpolation noise-ratio",
    .parameters = parameters,
    .stamps = stamps,
    .run = run_bias};
