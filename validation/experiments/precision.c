/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Experiment `precision` (beyond the paper): the error of one galaxy with the default settings, and
 * with each of their steps switched on or off. */
#include "engine/must.h"
#include "engine/trial.h"
#include "experiments/list.h"
#include "report/run.h"

#include <math.h>
#include <string.h>

/* A way to measure: the differences from the default settings, "setting=value setting=value". */
typedef struct step {
    const char *label, *change;
} step;
static const step steps[] = {
    {"defaults", ""},
    {"beta-ratio 1.5", "beta-ratio=1.5"},
    {"beta-ratio 2", "beta-ratio=2"},
    {"beta-ratio 2.5", "beta-ratio=2.5"},
    {"no filter", "filter=none"},
    {"core 20 px", "core=20 width=2.3"},
    {"noise level not fitted", "noise-level=none"},
    {"version 0.1", "beta-ratio=1.5 filter=none background=keep noise-level=none beta-floor=0"},
};
enum { N_STEPS = sizeof steps / sizeof steps[0] };

static const parameter parameters[] = {
    {"snrs", "100,30,15,10,8", 1, 1e6, TRIAL_MAX_LEVELS - 1,
     "signal-to-noise of equal galaxies, as in GREAT3"},
    {"broad", "10", 1, 1e6, 1, "of the faintest, where fluxes have a power law"},
    {"range", "40", 1, 1e6, 1, "largest flux over the smallest of these"},
    {"steps", "0,1,2,3,4,5,6,7", 0, N_STEPS - 1, MAX_VALUES,
     "0 defaults, 1-3 beta-ratio 1.5, 2, 2.5, 4 no filter, 5 a core of 20 px, 6 the noise's level "
     "not fitted, 7 version 0.1"},
    {0}};

static int64_t stamps(const options *o) {
    return 2 * o->galaxies;
}

/* ---- the ways: two per step, the mean and pdf-sym ---- */

static const step *step_of(const options *o, int way) {
    return &steps[(int)options_list(o, "steps")->v[way / 2]];
}

static void change(shear_settings *s, const char *text) {
    char copy[128];
    char *rest = NULL;
    snprintf(copy, sizeof copy, "%s", text);
    for (char *name = strtok_r(copy, " =", &rest); name != NULL;
         name = strtok_r(NULL, " =", &rest)) {
        must(shear_settings_set(s, name, strtok_r(NULL, " =", &rest), &must_error));
    }
}

static trial trial_of(const options *o) {
    const parameter_values *snrs = options_list(o, "snrs");
    const int n_steps = options_list(o, "steps")->n;
    trial t = trial_of_options(o, 1);
    for (int i = 0; i < snrs->n; i++)
        t.levels[t.n_levels++] = (trial_level){.snr = snrs->v[i], .range = 1.0};
    t.levels[t.n_levels++] =
        (trial_level){.snr = options_number(o, "broad"), .range = options_number(o, "range")};
    t.n_ways = n_steps < N_STEPS ? 2 * n_steps : 2 * N_STEPS;
    for (int i = 0; i < t.n_ways; i++) {
        t.ways[i] = o->settings;
        change(&t.ways[i], step_of(o, i)->change);
        t.ways[i].estimator = i % 2 != 0 ? SHEAR_ESTIMATOR_PDF_SYM : SHEAR_ESTIMATOR_MEAN;
    }
    return t;
}

/* ---- table; out [n_levels][n_ways] ---- */

static const column columns[] = {
    {"step", TABLE_TEXT, 0, .help = "what differs from the defaults"},
    {"estimator", TABLE_TEXT, 0, .help = "mean or pdf-sym"},
    {"snr", TABLE_NUMBER, 0, .help = "signal-to-noise, of the faintest galaxies"},
    {"range", TABLE_NUMBER, 0, .help = "largest flux over the smallest"},
    {"error", TABLE_NUMBER, 3, .help = "of one galaxy and component", .with_error = true},
    {"quoted", TABLE_NUMBER, 3, .help = "the same as the library quotes it"},
    {"m", TABLE_NUMBER, 4, .help = "multiplicative bias along the shear", .with_error = true},
    {0}};

static void conclude(table *t, const char *label, const trial_level *l, const trial_outcome *mean,
                     const trial_outcome *pdf) {
    table_meta(t, TABLE_CONCLUSION,
               "S/N %g%s, %s: error of one galaxy %.3f +- %.3f (mean), %.3f +- %.3f "
               "(pdf-sym); m %+.1f +- %.1f and %+.1f +- %.1f, 10^-3",
               l->snr, l->range > 1.0 ? " and more, broad fluxes" : "", label, mean->error,
               mean->error_err, pdf->error, pdf->error_err, 1e3 * mean->m, 1e3 * mean->m_err,
               1e3 * pdf->m, 1e3 * pdf->m_err);
}

static void tabulate(run *r, const trial *t, const trial_outcome *out) {
    table_columns(r->table, columns);
    for (int i = 0; i < t->n_ways * t->n_levels; i++) {
        const int way = i / t->n_levels;
        const trial_level *level = &t->levels[i % t->n_levels];
        const trial_outcome *o = &out[i % t->n_levels * t->n_ways + way];
        table_texts(r->table, step_of(r->options, way)->label, way % 2 != 0 ? "pdf-sym" : "mean");
        table_numbers(r->table, level->snr, level->range, o->error, o->error_err, o->quoted, o->m,
                      o->m_err);
    }
    for (int i = 0; i < t->n_levels; i++) {
        const trial_outcome *first = out + i * t->n_ways;
        conclude(r->table, step_of(r->options, 0)->label, &t->levels[i], &first[0], &first[1]);
    }
}

/* ---- figure: a panel per estimator; equal galaxies ---- */

static void draw_panel(const panels *p, const options *o, const trial *t, const trial_outcome *out,
                       int pdf) {
    static const enum shear_marker markers[] = {SHEAR_DISC,  SHEAR_CIRCLE, SHEAR_SQUARE,
                                                SHEAR_CROSS, SHEAR_PLUS,   SHEAR_TRIANGLE};
    curve curves[N_STEPS] = {0};
    for (int i = 0; i < t->n_ways / 2; i++) {
        curves[i].label = pdf != 0 ? NULL : step_of(o, 2 * i)->label;
        curves[i].hue = (enum shear_hue)(i % SHEAR_N_HUES);
        curves[i].marker = markers[i % 6];
        for (int level = 0; level + 1 < t->n_levels; level++) {
            const trial_outcome *at = &out[level * t->n_ways + 2 * i + pdf];
            curve_add(&curves[i], t->levels[level].snr, at->error, at->error_err);
        }
    }
    panels_draw(p, pdf,
                &(chart){pdf != 0 ? "pdf-sym" : "mean", "S/N", "error of one galaxy", .log_x = true,
                         .legend = SHEAR_TOP_RIGHT, .truth = NAN, .spread = 0.01,
                         .n_curves = t->n_ways / 2, .curves = curves});
}

static void run_precision(run *r) {
    const trial t = trial_of(r->options);
    CLEANUP(release_free) trial_outcome *out = trial_run(&t, r->cache, "galaxies");
    tabulate(r, &t, out);
    const panels p =
        run_panels(r, NULL, 1000, 440, (shear_grid){.rows = 1, .columns = 2, .gap_x = 12});
    draw_panel(&p, r->options, &t, out, 0);
    draw_panel(&p, r->options, &t, out, 1);
}

const experiment experiment_precision = {
    "precision",
    "beyond the paper: the error of one galaxy against signal-to-noise",
    "Galaxies of disk and bulge at random angles behind a Moffat PSF, in white noise: the\n"
    "error of one galaxy by the mean and by pdf-sym, against signal-to-noise and for a broad\n"
    "power law of fluxes, by the defaults and by each of their steps on or off; and m, from\n"
    "the same galaxies and noise at opposite shears.",
    .defaults = "preset=default shear=0.03,-0.02 galaxies=20000 groups=100",
    .fixed = trial_fixed,
    .parameters = parameters,
    .stamps = stamps,
    .run = run_precision};
