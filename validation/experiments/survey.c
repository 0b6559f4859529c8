/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beyond the paper: the shear of imperfect data by the default settings. */
#include "experiments/survey.h"
#include "engine/experiment.h"
#include "engine/must.h"
#include "report/run.h"

#include <math.h>
#include <stdlib.h>

static const struct knob knobs[] = {
    {"snrs", "100,30,15,10", 1, 1e6, true, "signal-to-noise of the galaxies, as in GREAT3"},
    {"rows", "0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25", 0, 99, true,
     "which rows of the table"},
    {"least", "256", 64, 1e9, false, "stamps of a row that has fewer, at least"},
    {0}};

static void defaults(struct request *r) {
    (void)shear_settings_set(&r->settings, "preset", "default", NULL);
    r->mock.g1 = 0.03;
    r->mock.g2 = -0.02;
    r->galaxies = 20000;
    r->groups = 40;
}

static struct trial trial_of(const struct request *r, int row) {
    const struct flaw *f = &flaws[row];
    const knob_values *snrs = request_list(r, "snrs");
    const double fewer =
        fmax((double)r->galaxies / (f->fewer > 1 ? f->fewer : 1), request_number(r, "least"));
    struct trial t = {.flaw = f,
                      .seed = r->mock.seed,
                      .stamps = (int64_t)(fewer / 64.0) * 64,
                      .groups = f->fewer > 4 && r->groups > 8 ? 8 : r->groups,
                      .threads = r->threads,
                      .copies = 4,
                      .g = {r->mock.g1, r->mock.g2},
                      .n_ways = SURVEY_WAYS};
    for (int i = 0; i < snrs->n && i < TRIAL_MAX_LEVELS; i++) {
        t.levels[t.n_levels++] = (trial_level){.snr = snrs->v[i], .range = 1.0};
    }
    for (int i = 0; i < SURVEY_WAYS; i++) {
        t.ways[i] = r->settings;
        t.ways[i].estimator = i == 0 ? SHEAR_ESTIMATOR_MEAN : SHEAR_ESTIMATOR_PDF_SYM;
    }
    return t;
}

static int work(void *context, int chunk, double *values, shear_error *err) {
    (void)chunk;
    return trial_run(context, (trial_outcome *)values, err);
}

static int measure(struct ledger *ledger, struct trial *t, trial_outcome *out, shear_error *err) {
    const struct task task = {.name = t->flaw->name,
                              .chunks = 1,
                              .values = t->n_levels * t->n_ways * TRIAL_VALUES,
                              .stamps_of_chunk = 2 * t->stamps,
                              .work = work,
                              .context = t};
    return ledger_run(ledger, &task, (double *)out, err);
}

static int check(const struct request *r, int64_t *total, shear_error *err) {
    const knob_values *rows = request_list(r, "rows");
    if (request_list(r, "snrs")->n > TRIAL_MAX_LEVELS) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "option '--snrs': at most %d",
                          TRIAL_MAX_LEVELS);
    }
    for (int i = 0; i < rows->n; i++) {
        if (rows->v[i] >= flaw_count()) {
            return shear_fail(err, SHEAR_E_SETTING, NULL, "option '--rows': there is no row %g",
                              rows->v[i]);
        }
        *total += 2 * trial_of(r, (int)rows->v[i]).stamps;
    }
    return SHEAR_OK;
}

static int exec(const struct request *r, shear_error *err) {
    const knob_values *rows = request_list(r, "rows");
    struct ledger *ledger = NULL;
    int64_t total = 0;
    int code = check(r, &total, err);
    struct survey *s = memory_new(1, sizeof *s, "results", &code, err);
    code = code != SHEAR_OK ? code : ledger_open(&ledger, r, total, err);
    for (int i = 0; code == SHEAR_OK && i < rows->n; i++) {
        struct trial t = trial_of(r, (int)rows->v[i]);
        s->rows[s->n] = (int)rows->v[i];
        s->n_levels = t.n_levels;
        code = measure(ledger, &t, s->out[s->n++], err);
    }
    code = code != SHEAR_OK ? code : survey_report(r, ledger, s, err);
    ledger_close(ledger);
    free(s);
    return code;
}

const experiment exp_survey = {
    .name = "survey",
    .summary = "beyond the paper: the shear of imperfect data by the default settings",
    .about =
        "Galaxies of disk and bulge behind a Moffat PSF (or one of a space telescope), in fours\n"
        "at +g and -g in the same noise, under what real data have: noise that the noise stamps\n"
        "do not show, source photons, a sky, artefacts, a PSF that is not what it should be,\n"
        "files made wrongly. m and c by the default settings for the mean and for pdf-sym, and\n"
        "whether the library refused, flagged or warned; each row beside what is asked of it.",
    .knobs = knobs,
    .fixed = trial_fixed,
    .defaults = defaults,
    .exec = exec,
};
