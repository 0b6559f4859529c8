/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Section 4.3, last figure: the six interpolations against the size of the pixels. */
#include "experiments/pixels.h"
#include "engine/experiment.h"
#include "engine/methods.h"

#include <stdlib.h>

static const struct knob knobs[] = {
    {"ratios", "0.25,0.5,0.75,1,1.25,1.5,2,2.5,3", 0.05, 8, true, "pixel size over R_PSF"},
    {"sizes", "6.67,3.33,1.67", 0.5, 50, true, "R_G over R_PSF, at most three"},
    {"step", "0.075", 0.001, 1, false, "step of the random walk over R_G"},
    {"beta", "1.33333333333333333", 0.5, 10, false, "beta over R_PSF"},
    {"coarse", "1", 0, 1, false, "1: also with the PSF as coarse as the pixels"},
    {0}};

static const char *const fixed[] = {"size",       "r-gal",         "r-psf",    "step-size", "beta",
                                    "beta-ratio", "interpolation", "oversamp", NULL};

static void defaults(struct request *r) {
    r->mock.g1 = -0.031;
    r->mock.g2 = 0.018;
    r->mock.rotate = 1;
    r->mock.galaxy = SHEAR_MOCK_IRREGULAR;
    r->mock.psf = SHEAR_MOCK_PSF_B;
    r->settings.filter = SHEAR_FILTER_NONE;
    r->settings.zeros = SHEAR_ZEROS_FLOOR;
}

/* Galaxies of R_G = size R_PSF at pixels of ratio R_PSF. */
static struct scene scene_at(const struct request *r, double size, double ratio) {
    struct scene s = {.spec = r->mock};
    s.spec.r_psf_px = 1.0 / ratio;
    s.spec.r_gal_px = size / ratio;
    s.spec.step_px = request_number(r, "step") * s.spec.r_gal_px;
    s.spec.nx = s.spec.ny = stamp_side(s.spec.r_gal_px, s.spec.r_psf_px);
    return s;
}

static int measure(const struct request *r, struct ledger *ledger, const char *name,
                   const struct scene *scene, const struct series *series, int n,
                   struct tally **tally, shear_error *err) {
    const sample_spec spec = {.name = name,
                              .stamps = r->galaxies,
                              .groups = r->groups,
                              .threads = r->threads,
                              .n_scenes = 1,
                              .scenes = scene,
                              .n_series = n,
                              .series = series};
    return sample_measure(&spec, ledger, tally, err);
}

static shear_settings settings_at(const struct request *r, double ratio) {
    shear_settings s = r->settings;
    s.beta_px = request_number(r, "beta") / ratio;
    return s;
}

/* What the measurement gives where pixels do not matter: R_PSF = 4 pixels, not interpolated. */
static int measure_reference(const struct request *r, struct ledger *ledger, double size,
                             struct tally **tally, shear_error *err) {
    static const double fine = 0.25;
    char name[48];
    const struct scene scene = scene_at(r, size, fine);
    struct series series = {.settings = settings_at(r, fine)};
    series.settings.interpolation = SHEAR_INTERP_NONE;
    series.settings.oversample = 0;
    snprintf(name, sizeof name, "reference:R_G=%g", size);
    return measure(r, ledger, name, &scene, &series, 1, tally, err);
}

static int measure_ratio(const struct request *r, struct ledger *ledger, double size, double ratio,
                         struct tally *all, shear_error *err) {
    char name[64];
    struct series series[PIXELS_SERIES];
    struct tally *tally = NULL;
    const struct scene scene = scene_at(r, size, ratio);
    const shear_settings settings = settings_at(r, ratio);
    int n = pixels_samplings(r) * N_METHODS;
    for (int i = 0; i < n; i++) {
        series[i] = method_series(0, i % N_METHODS, (enum psf_sampling)(i / N_METHODS), 1.0 / ratio,
                                  &settings);
    }
    snprintf(name, sizeof name, "R_G=%g,pixel=%g", size, ratio);
    int code = measure(r, ledger, name, &scene, series, n, &tally, err);
    code = code != SHEAR_OK ? code : tally_append(all, tally, err);
    tally_free(tally);
    return code;
}

/* One tally a size: the reference, then the series of each ratio. */
static int measure_size(const struct request *r, struct ledger *ledger, double size,
                        struct tally **tally, shear_error *err) {
    const knob_values *ratios = request_list(r, "ratios");
    int code = measure_reference(r, ledger, size, tally, err);
    for (int k = 0; code == SHEAR_OK && k < ratios->n; k++) {
        code = measure_ratio(r, ledger, size, ratios->v[k], *tally, err);
    }
    return code;
}

static int exec(const struct request *r, shear_error *err) {
    const knob_values *sizes = request_list(r, "sizes");
    struct ledger *ledger = NULL;
    struct tally *tallies[PIXELS_MAX_SIZES] = {0};
    int64_t total = r->galaxies * sizes->n * (request_list(r, "ratios")->n + 1);
    int code = sizes->n <= PIXELS_MAX_SIZES
                   ? ledger_open(&ledger, r, total, err)
                   : shear_fail(err, SHEAR_E_SETTING, NULL, "option '--sizes': at most %d",
                                PIXELS_MAX_SIZES);
    for (int i = 0; code == SHEAR_OK && i < sizes->n; i++) {
        code = measure_size(r, ledger, sizes->v[i], &tallies[i], err);
    }
    code = code != SHEAR_OK ? code : pixels_report(r, ledger, tallies, err);
    for (int i = 0; i < PIXELS_MAX_SIZES; i++) {
        tally_free(tallies[i]);
    }
    ledger_close(ledger);
    return code;
}

const experiment exp_pixels = {
    .name = "pixels",
    .summary = "section 4.3: shear against the size of the pixels, six interpolations",
    .about = "Irregular galaxies of 1000 steps under W_B, beta = 4/3 R_PSF, without noise, in "
             "three sizes\n"
             "(R_G and step 6.67 and 0.5, 3.33 and 0.25, 1.67 and 0.125 R_PSF). The PSF is given "
             "finely\n"
             "sampled, and again as coarse as the pixels (pixels-coarse.png). Beside the true "
             "shear stands\n"
             "what the same galaxies give where pixels do not matter (R_PSF = 4 pixels): "
             "deviations from\n"
             "it are free of the scatter of the galaxies' shapes.",
    .knobs = knobs,
    .fixed = fixed,
    .defaults = defaults,
    .exec = exec,
};
