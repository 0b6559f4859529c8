/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/trial.h"

#include "engine/must.h"
#include "engine/scratch.h"
#include "engine/trial_stamps.h"
#include "engine/trial_sums.h"
#include "shear/run.h"
#include "sheard/advice.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char trial_fixed[] =
    "size rotate no-shift offset share-shift share-noise turn-stamps galaxy r-gal points "
    "bulge-fraction disk-scale bulge-ratio inclination steps step-size psf r-psf psf-angle "
    "oversamp psf-size psf-per-stamp psf-ids noise-ratio noise-density white photons photon-snr "
    "subtract-background estimator";

char *trial_told_text(const trial_outcome *o, char *buf, size_t size) {
    static const char *const names[] = {"no", "warned", "flagged", "no shear", "refused"};
    snprintf(buf, size, "%s", names[(int)o->told]);
    if ((int)o->told == TOLD_REFUSED)
        snprintf(buf, size, "refused (%s)", shear_code_name((int)o->code));
    return buf;
}

trial trial_of_options(const options *o, int copies) {
    return (trial){.flaw = &flaws[0],
                   .seed = o->mock.seed,
                   .stamps = o->galaxies,
                   .groups = o->groups,
                   .threads = o->threads,
                   .copies = copies,
                   .g = {o->mock.g1, o->mock.g2}};
}

/* A running trial. */
typedef struct running {
    const trial *of;
    int groups; /* files per sign of the shear */
    trial_stamps *stamps;
    trial_sums **sums;     /* [n_levels][n_ways] */
    shear_plan_info *plan; /* the same */
    trial_outcome *out;    /* the same */
} running;

/* Return the number of groups. Small files (flaw.stamps) are fields of their own. */
static int groups_of(const trial *t) {
    return t->flaw->stamps > 0 ? (int)(t->stamps / t->flaw->stamps) : t->groups;
}

int64_t trial_begin(const trial *t, int group) {
    if (t->flaw->stamps > 0)
        return (int64_t)group * t->flaw->stamps;
    return t->stamps / t->copies * group / t->groups * t->copies;
}

/* ---- reports ---- */

static void tell(trial_outcome *out, enum trial_told told) {
    out->told = fmax(out->told, told);
}

static void tell_result(trial_outcome *out, const shear_result *r, const shear_plan_info *plan) {
    sheard_advice_list list;
    if (!r->valid)
        tell(out, TOLD_NO_SHEAR);
    if (r->n_flagged > 0)
        tell(out, TOLD_FLAGGED);
    sheard_advice_all(&list, r, plan, NULL);
    for (size_t i = 0; i < list.n; i++) {
        tell(out, TOLD_WARNED);
        out->edge = strstr(list.lines[i], "filter edge") != NULL ? 1.0 : out->edge;
    }
}

/* ---- measuring ---- */

static bool is_refusal(int code) {
    return code == SHEAR_E_PSF || code == SHEAR_E_BETA || code == SHEAR_E_NEGATIVE ||
           code == SHEAR_E_FORMAT;
}

/* Measure one file in one way. A small file is a field of its own, so its report counts, too. */
static void measure(running *s, int i, int sign, int group) {
    const flaw *f = s->of->flaw;
    const int at = sign * s->groups + group;
    trial_sums *sums = s->sums[i];
    trial_outcome *out = &s->out[i];
    shear_run_report report;
    shear_settings settings = s->of->ways[i % s->of->n_ways];
    if (f->core_px > 0.0) {
        settings.filter = SHEAR_FILTER_AUTO;
        settings.core_px = f->core_px;
    }
    const shear_run_options how = {.threads = s->of->threads, .terms = sums->terms[at]};
    const int code =
        shear_run_file(scratch_path(), &settings, &how, sums->sums[at], NULL, &report, &must_error);
    if (is_refusal(code)) {
        sums->refused = true;
        tell(out, TOLD_REFUSED);
        out->code = code;
        return;
    }
    must(code);
    if (f->stamps > 0 || at == 0)
        s->plan[i] = report.plan;
    if (f->stamps > 0)
        tell_result(out, &report.result, &report.plan);
}

static void do_group(running *s, int group) {
    const trial *t = s->of;
    const int64_t first = trial_begin(t, group);
    const int count = (int)(trial_begin(t, group + 1) - first);
    double spoilt = 0.0;
    trial_stamps_draw(s->stamps, first, count);
    for (int k = 0; k < count; k++)
        spoilt += 2.0 * flaw_spoils(t->flaw, t->seed, first + k);
    for (int level = 0; level < t->n_levels; level++) {
        for (int sign = 0; sign < 2; sign++) {
            trial_stamps_write(s->stamps, &t->levels[level], sign, scratch_path());
            for (int i = level * t->n_ways; i < (level + 1) * t->n_ways; i++)
                measure(s, i, sign, group);
        }
    }
    for (int i = 0; i < t->n_levels * t->n_ways; i++)
        s->out[i].spoilt += spoilt;
}

/* ---- the trial ---- */

static void conclude(const running *s, int i) {
    trial_outcome *out = &s->out[i];
    trial_sums_conclude(s->sums[i], s->of, out);
    for (int sign = 0; sign < 2 && out->told < TOLD_REFUSED; sign++) {
        const shear_result r = trial_sums_result(s->sums[i], sign);
        tell_result(out, &r, &s->plan[i]);
    }
}

static void prepare(running *s) {
    const trial *t = s->of;
    const int n = t->n_levels * t->n_ways;
    int64_t most = 0;
    s->groups = groups_of(t);
    if (s->groups < 2 || s->groups > t->stamps / t->copies) {
        must_fail(SHEAR_E_SETTING, "ask for more galaxies",
                  "%s: %lld stamps are too few for %d groups", t->flaw->name, (long long)t->stamps,
                  s->groups);
    }
    for (int i = 0; i < s->groups; i++) {
        const int64_t count = trial_begin(t, i + 1) - trial_begin(t, i);
        most = count > most ? count : most;
    }
    s->sums = must_allocate((size_t)n, sizeof(trial_sums *), "sums");
    s->plan = must_allocate((size_t)n, sizeof *s->plan, "plans");
    for (int i = 0; i < n; i++) {
        s->sums[i] = trial_sums_new(s->groups, t->ways[i % t->n_ways].estimator);
        s->out[i] = (trial_outcome){0};
    }
    s->stamps = trial_stamps_new(t, (int)most);
}

static void work(void *context, int chunk, double *values) {
    const trial *t = context;
    running s = {.of = t, .out = (trial_outcome *)values};
    assert(chunk == 0);
    (void)chunk;
    prepare(&s);
    for (int group = 0; group < s.groups; group++)
        do_group(&s, group);
    for (int i = 0; i < t->n_levels * t->n_ways; i++) {
        conclude(&s, i);
        trial_sums_free(s.sums[i]);
    }
    free(s.sums);
    free(s.plan);
    trial_stamps_free(s.stamps);
}

trial_outcome *trial_run(const trial *t, cache *c, const char *name) {
    trial copy = *t;
    const cache_task task = {.name = name,
                             .chunks = 1,
                             .values = t->n_levels * t->n_ways * TRIAL_VALUES,
                             .stamps_of_chunk = 2 * t->stamps,
                             .work = work,
                             .context = &copy};
    return (trial_outcome *)cache_run(c, &task);
}
