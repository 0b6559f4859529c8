/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/trial.h"
#include "engine/must.h"
#include "engine/scratch.h"
#include "engine/trial_stamps.h"
#include "engine/trial_sums.h"

#include "shear/run.h"
#include "sheard/advice.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const trial_fixed[] = {"size",
                                   "rotate",
                                   "no-shift",
                                   "offset",
                                   "share-shift",
                                   "share-noise",
                                   "turn-stamps",
                                   "galaxy",
                                   "r-gal",
                                   "points",
                                   "bulge-fraction",
                                   "disk-scale",
                                   "bulge-ratio",
                                   "inclination",
                                   "steps",
                                   "step-size",
                                   "psf",
                                   "r-psf",
                                   "psf-angle",
                                   "oversamp",
                                   "psf-size",
                                   "psf-per-stamp",
                                   "psf-ids",
                                   "noise-ratio",
                                   "noise-density",
                                   "white",
                                   "photons",
                                   "photon-snr",
                                   "subtract-background",
                                   "estimator",
                                   NULL};

char *trial_told_text(const trial_outcome *o, char *buf, size_t size) {
    static const char *const names[] = {"no", "warned", "flagged", "no shear", "refused"};
    const int told = (int)o->told;
    snprintf(buf, size, "%s", names[told]);
    if (told == TOLD_REFUSED) {
        snprintf(buf, size, "refused (%s)", shear_code_name((int)o->code));
    }
    return buf;
}

/* A trial under way. */
struct run {
    const struct trial *trial;
    int groups; /* files at each sign */
    struct studio *studio;
    harvest *harvests;     /* [n_levels][n_ways] */
    shear_plan_info *plan; /* the same */
    trial_outcome *out;
    char path[SCRATCH_PATH];
};

/* The first stamp of a group; whole galaxies stay together. */
static int64_t begin_of(const struct run *run, int group) {
    const struct trial *t = run->trial;
    const int64_t galaxies = t->stamps / t->copies;
    if (t->flaw->stamps > 0) {
        return (int64_t)group * t->flaw->stamps;
    }
    return galaxies * group / run->groups * t->copies;
}

/* ---- telling ---- */

static void tell(trial_outcome *out, int told) {
    out->told = fmax(out->told, told);
}

static void tell_advice(trial_outcome *out, const shear_result *r, const shear_plan_info *plan) {
    sheard_advice_list list;
    sheard_advice_all(&list, r, plan, NULL);
    for (size_t i = 0; i < list.n; i++) {
        tell(out, TOLD_WARNED);
        out->edge = strstr(list.lines[i], "filter edge") != NULL ? 1.0 : out->edge;
    }
}

static void tell_result(trial_outcome *out, const shear_result *r, const shear_plan_info *plan) {
    if (!r->valid) {
        tell(out, TOLD_NO_SHEAR);
    }
    if (r->n_flagged > 0) {
        tell(out, TOLD_FLAGGED);
    }
    tell_advice(out, r, plan);
}

/* ---- measuring ---- */

static bool is_refusal(int code) {
    return code == SHEAR_E_PSF || code == SHEAR_E_BETA || code == SHEAR_E_NEGATIVE ||
           code == SHEAR_E_FORMAT;
}

/* One file by one way. Small files (flaw.stamps) are fields of their own: each is told about. */
static int measure(struct run *run, int level, int way, int at, shear_error *err) {
    const struct trial *t = run->trial;
    const int index = level * t->n_ways + way;
    harvest *h = &run->harvests[index];
    trial_outcome *out = &run->out[index];
    shear_run_report report;
    shear_settings settings = t->ways[way];
    if (t->flaw->core_px > 0.0) {
        settings.filter = SHEAR_FILTER_AUTO;
        settings.core_px = t->flaw->core_px;
    }
    const shear_run_options options = {.threads = t->threads, .terms = h->terms[at]};
    const int code =
        shear_run_file(run->path, &settings, &options, h->sums[at], NULL, &report, err);
    if (is_refusal(code)) {
        h->refused = true;
        tell(out, TOLD_REFUSED);
        out->code = code;
        return SHEAR_OK;
    }
    if (code == SHEAR_OK && (t->flaw->stamps > 0 || at == 0)) {
        run->plan[index] = report.plan;
    }
    if (code == SHEAR_OK && t->flaw->stamps > 0) {
        tell_result(out, &report.result, &report.plan);
    }
    return code;
}

static void count_spoilt(struct run *run, int64_t first, int count) {
    const struct trial *t = run->trial;
    for (int i = 0; i < t->n_levels * t->n_ways; i++) {
        for (int k = 0; k < count; k++) {
            run->out[i].spoilt += 2.0 * flaw_spoils(t->flaw, t->seed, first + k);
        }
    }
}

static int do_group(struct run *run, int group, shear_error *err) {
    const struct trial *t = run->trial;
    const int64_t first = begin_of(run, group);
    const int count = (int)(begin_of(run, group + 1) - first);
    int code = studio_draw(run->studio, first, count, err);
    count_spoilt(run, first, count);
    for (int level = 0; level < t->n_levels; level++) {
        for (int sign = 0; code == SHEAR_OK && sign < 2; sign++) {
            code = studio_write(run->studio, &t->levels[level], sign, run->path, err);
            for (int way = 0; code == SHEAR_OK && way < t->n_ways; way++) {
                code = measure(run, level, way, sign * run->groups + group, err);
            }
        }
    }
    return code;
}

/* ---- the whole ---- */

static int judge(struct run *run, int index, shear_error *err) {
    const harvest *h = &run->harvests[index];
    trial_outcome *out = &run->out[index];
    shear_result r;
    int code = harvest_judge(h, run->trial, out, err);
    for (int sign = 0; code == SHEAR_OK && !h->refused && sign < 2; sign++) {
        code = harvest_result(h, sign, &r, err);
        if (code == SHEAR_OK) {
            tell_result(out, &r, &run->plan[index]);
        }
    }
    return code;
}

static int prepare(struct run *run, shear_error *err) {
    const struct trial *t = run->trial;
    const int n = t->n_levels * t->n_ways;
    int code = SHEAR_OK;
    int64_t most = 0;
    run->groups = t->flaw->stamps > 0 ? (int)(t->stamps / t->flaw->stamps) : t->groups;
    if (run->groups < 2 || run->groups > t->stamps / t->copies) {
        return shear_fail(err, SHEAR_E_SETTING, "ask for more galaxies",
                          "%s: %lld stamps are too few for %d groups", t->flaw->name,
                          (long long)t->stamps, run->groups);
    }
    for (int i = 0; i < run->groups; i++) {
        const int64_t count = begin_of(run, i + 1) - begin_of(run, i);
        most = count > most ? count : most;
    }
    run->harvests = memory_new((size_t)n, sizeof *run->harvests, "sums", &code, err);
    run->plan = memory_new((size_t)n, sizeof *run->plan, "plans", &code, err);
    for (int i = 0; code == SHEAR_OK && i < n; i++) {
        code = harvest_init(&run->harvests[i], run->groups, t->ways[i % t->n_ways].estimator, err);
        run->out[i] = (trial_outcome){0};
    }
    code = code != SHEAR_OK ? code : studio_new(&run->studio, t, (int)most, err);
    return code != SHEAR_OK ? code : scratch_new(run->path, err);
}

int trial_run(const struct trial *t, trial_outcome *out, shear_error *err) {
    struct run run = {.trial = t, .out = out};
    int code = prepare(&run, err);
    for (int group = 0; code == SHEAR_OK && group < run.groups; group++) {
        code = do_group(&run, group, err);
    }
    for (int i = 0; code == SHEAR_OK && i < t->n_levels * t->n_ways; i++) {
        code = judge(&run, i, err);
    }
    for (int i = 0; run.harvests != NULL && i < t->n_levels * t->n_ways; i++) {
        harvest_deinit(&run.harvests[i]);
    }
    free(run.harvests);
    free(run.plan);
    studio_free(run.studio);
    scratch_free(run.path);
    return code;
}
