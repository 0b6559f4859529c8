/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beyond the paper: the error of one galaxy by the defaults, and by each of their steps on or off.
 */
#include "engine/experiment.h"
#include "engine/must.h"
#include "engine/trial.h"
#include "report/chart.h"
#include "report/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A way to measure: the defaults, and what differs from them, "setting=value ?setting=value". A
 * setting that the library does not have leaves the step out; with a question mark, only itself. */
struct step {
    const char *label, *change;
};
static const struct step steps[] = {
    {"defaults", ""},
    {"beta-ratio 1.5", "beta-ratio=1.5"},
    {"beta-ratio 2", "beta-ratio=2"},
    {"beta-ratio 2.5", "beta-ratio=2.5"},
    {"no filter", "filter=none"},
    {"core 20 px", "core=20 width=2.3"},
    {"noise level not fitted", "noise-level=none"},
    {"version 0.1", "beta-ratio=1.5 filter=none background=keep ?noise-level=none ?beta-floor=0"},
};
enum { N_STEPS = sizeof steps / sizeof steps[0], MAX_CURVES = N_STEPS };

static const struct knob knobs[] = {
    {"snrs", "100,30,15,10,8", 1, 1e6, true, "signal-to-noise of equal galaxies, as in GREAT3"},
    {"broad", "10", 1, 1e6, false, "of the faintest, where fluxes have a power law"},
    {"range", "40", 1, 1e6, false, "largest flux over the smallest of these"},
    {"steps", "0,1,2,3,4,5,6,7", 0, N_STEPS - 1, true,
     "0 defaults, 1-3 beta-ratio 1.5, 2, 2.5, 4 no filter, 5 a core of 20 px, 6 the noise's level "
     "not fitted, 7 version 0.1"},
    {0}};

static void defaults(struct request *r) {
    (void)shear_settings_set(&r->settings, "preset", "default", NULL);
    r->mock.g1 = 0.03;
    r->mock.g2 = -0.02;
    r->galaxies = 20000;
    r->groups = 100;
}

/* ---- the ways ---- */

struct ways {
    int n;             /* steps that there are; the trial's ways are 2 n */
    int step[N_STEPS]; /* of the table */
    struct trial trial;
};

/* False where a setting is not there. */
static bool change(shear_settings *s, const char *text, int *code, shear_error *err) {
    char copy[128];
    char *rest = NULL;
    snprintf(copy, sizeof copy, "%s", text);
    for (char *word = strtok_r(copy, " ", &rest); word; word = strtok_r(NULL, " ", &rest)) {
        const bool optional = word[0] == '?';
        const char *name = word + optional;
        char *value = strchr(word, '=');
        *value++ = '\0';
        const bool known = shear_settings_find(name) != NULL;
        if (!known && !optional) {
            return false;
        }
        *code = *code || !known ? *code : shear_settings_set(s, name, value, err);
    }
    return true;
}

static int list_ways(const struct request *r, struct ways *w, shear_error *err) {
    int code = SHEAR_OK;
    const knob_values *wanted = request_list(r, "steps");
    for (int k = 0; k < wanted->n && w->n < N_STEPS; k++) {
        const int i = (int)wanted->v[k];
        shear_settings s = r->settings;
        if (!change(&s, steps[i].change, &code, err)) {
            continue;
        }
        w->step[w->n++] = i;
        for (int pdf = 0; pdf < 2; pdf++) {
            s.estimator = pdf != 0 ? SHEAR_ESTIMATOR_PDF_SYM : SHEAR_ESTIMATOR_MEAN;
            w->trial.ways[w->trial.n_ways++] = s;
        }
    }
    return code;
}

static int prepare(const struct request *r, struct ways *w, shear_error *err) {
    const knob_values *snrs = request_list(r, "snrs");
    struct trial *t = &w->trial;
    *w = (struct ways){.trial = {.flaw = &flaws[0],
                                 .seed = r->mock.seed,
                                 .stamps = r->galaxies,
                                 .groups = r->groups,
                                 .threads = r->threads,
                                 .copies = 1,
                                 .g = {r->mock.g1, r->mock.g2}}};
    if (snrs->n >= TRIAL_MAX_LEVELS) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "option '--snrs': at most %d",
                          TRIAL_MAX_LEVELS - 1);
    }
    for (int i = 0; i < snrs->n; i++) {
        t->levels[t->n_levels++] = (trial_level){.snr = snrs->v[i], .range = 1.0};
    }
    t->levels[t->n_levels++] =
        (trial_level){.snr = request_number(r, "broad"), .range = request_number(r, "range")};
    return list_ways(r, w, err);
}

/* ---- table ---- */

static void add_columns(struct table *t) {
    table_column(t, "step", TABLE_TEXT, 0, "", "what differs from the defaults");
    table_column(t, "estimator", TABLE_TEXT, 0, "", "mean or pdf-sym");
    table_column(t, "snr", TABLE_NUMBER, 0, "", "signal-to-noise, of the faintest galaxies");
    table_column(t, "range", TABLE_NUMBER, 0, "", "largest flux over the smallest");
    table_column(t, "error", TABLE_NUMBER, 3, "", "of one galaxy and component");
    table_column(t, "error_err", TABLE_NUMBER, 3, "", "its 1-sigma error");
    table_column(t, "quoted", TABLE_NUMBER, 3, "", "the same as the library quotes it");
    table_column(t, "m", TABLE_NUMBER, 4, "", "multiplicative bias along the shear");
    table_column(t, "m_err", TABLE_NUMBER, 4, "", "its 1-sigma error");
}

static void add_row(struct table *t, const struct ways *w, int level, int way,
                    const trial_outcome *o) {
    table_text(t, steps[w->step[way / 2]].label);
    table_text(t, way % 2 ? "pdf-sym" : "mean");
    table_number(t, w->trial.levels[level].snr);
    table_number(t, w->trial.levels[level].range);
    table_number(t, o->error);
    table_number(t, o->error_err);
    table_number(t, o->quoted);
    table_number(t, o->m);
    table_number(t, o->m_err);
}

static void judge(struct table *t, const struct ways *w, const trial_outcome *out) {
    for (int level = 0; level < w->trial.n_levels; level++) {
        const trial_level *l = &w->trial.levels[level];
        const trial_outcome *o = out + level * w->trial.n_ways;
        table_meta(t, "verdict",
                   "S/N %g%s, %s: error of one galaxy %.3f +- %.3f (mean), %.3f +- %.3f "
                   "(pdf-sym); m %+.1f +- %.1f and %+.1f +- %.1f, 10^-3",
                   l->snr, l->range > 1.0 ? " and more, broad fluxes" : "", steps[w->step[0]].label,
                   o[0].error, o[0].error_err, o[1].error, o[1].error_err, 1e3 * o[0].m,
                   1e3 * o[0].m_err, 1e3 * o[1].m, 1e3 * o[1].m_err);
    }
}

static void tabulate(struct table *t, const struct ways *w, const trial_outcome *out) {
    add_columns(t);
    for (int way = 0; way < w->trial.n_ways; way++) {
        for (int level = 0; level < w->trial.n_levels; level++) {
            add_row(t, w, level, way, &out[level * w->trial.n_ways + way]);
        }
    }
    judge(t, w, out);
}

/* ---- figure: a panel for each estimator; equal galaxies ---- */

static void draw_panel(shear_figure *f, shear_rect cell, const struct ways *w,
                       const trial_outcome *out, int estimator) {
    static const int markers[] = {SHEAR_DISC,  SHEAR_CIRCLE, SHEAR_SQUARE,
                                  SHEAR_CROSS, SHEAR_PLUS,   SHEAR_TRIANGLE};
    struct curve curves[MAX_CURVES] = {0};
    for (int i = 0; i < w->n; i++) {
        curves[i].label = estimator == 0 ? steps[w->step[i]].label : NULL;
        curves[i].hue = i % SHEAR_N_HUES;
        curves[i].marker = markers[i % 6];
        for (int level = 0; level + 1 < w->trial.n_levels; level++) {
            const trial_outcome *o = &out[level * w->trial.n_ways + 2 * i + estimator];
            curve_add(&curves[i], w->trial.levels[level].snr, o->error, o->error_err);
        }
    }
    chart_draw(f, &(struct chart){.cell = cell,
                                  .title = estimator != 0 ? "pdf-sym" : "mean",
                                  .x_label = "S/N",
                                  .y_label = "error of one galaxy",
                                  .log_x = true,
                                  .legend = SHEAR_TOP_RIGHT,
                                  .truth = NAN,
                                  .spread = 0.01,
                                  .n_curves = w->n,
                                  .curves = curves});
}

static int report(const struct request *r, const struct ledger *ledger, const struct ways *w,
                  const trial_outcome *out, shear_error *err) {
    const shear_grid grid = {.area = {8, 8, 984, 424}, .rows = 1, .columns = 2, .gap_x = 12};
    struct table *t = table_new(r);
    shear_figure *f = NULL;
    tabulate(t, w, out);
    int code = shear_figure_new(&f, 1000, 440, err);
    for (int i = 0; code == SHEAR_OK && i < 2; i++) {
        draw_panel(f, shear_grid_cell(&grid, 0, i, 1, 1), w, out, i);
    }
    code = code != SHEAR_OK ? code : report_save(r, ledger, t, f, err);
    shear_figure_free(f);
    table_free(t);
    return code;
}

/* ---- all ---- */

static int work(void *context, int chunk, double *values, shear_error *err) {
    (void)chunk;
    return trial_run(context, (trial_outcome *)values, err);
}

static int exec(const struct request *r, shear_error *err) {
    struct ledger *ledger = NULL;
    struct ways w;
    int code = prepare(r, &w, err);
    const int n = w.trial.n_levels * w.trial.n_ways;
    const struct task task = {.name = "galaxies",
                              .chunks = 1,
                              .values = n * TRIAL_VALUES,
                              .stamps_of_chunk = 2 * r->galaxies,
                              .work = work,
                              .context = &w.trial};
    trial_outcome *out = memory_new((size_t)n, sizeof *out, "results", &code, err);
    code = code != SHEAR_OK ? code : ledger_open(&ledger, r, 2 * r->galaxies, err);
    code = code != SHEAR_OK ? code : ledger_run(ledger, &task, (double *)out, err);
    code = code != SHEAR_OK ? code : report(r, ledger, &w, out, err);
    ledger_close(ledger);
    free(out);
    return code;
}

const experiment exp_precision = {
    .name = "precision",
    .summary = "beyond the paper: the error of one galaxy against signal-to-noise",
    .about =
        "Galaxies of disk and bulge at random angles behind a Moffat PSF, in white noise: the\n"
        "error of one galaxy by the mean and by pdf-sym, against signal-to-noise and for a broad\n"
        "power law of fluxes, by the defaults and by each of their steps on or off; and m, from\n"
        "the same galaxies and noise at opposite shears.",
    .knobs = knobs,
    .fixed = trial_fixed,
    .defaults = defaults,
    .exec = exec,
};
