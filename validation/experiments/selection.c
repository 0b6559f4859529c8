/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beyond the paper: what a cut does to the shear, by what it is made on. */
#include "experiments/selection.h"
#include "engine/experiment.h"
#include "engine/must.h"
#include "engine/scratch.h"
#include "engine/trial_stamps.h"
#include "engine/trial_sums.h"

#include "shear/run.h"

#include <math.h>
#include <stdlib.h>

const char *const selection_cuts[N_CUTS] = {"true S/N",     "FLUX",          "SNR",
                                            "aperture S/N", "deep aperture", "D"};
const char *const selection_estimators[SELECTION_ESTIMATORS] = {"mean", "pdf-sym"};
static const enum shear_estimator estimators[SELECTION_ESTIMATORS] = {SHEAR_ESTIMATOR_MEAN,
                                                                      SHEAR_ESTIMATOR_PDF_SYM};

static const struct knob knobs[] = {
    {"kept", "1,0.9,0.8,0.7,0.6,0.5,0.4,0.3", 0.05, 1, true, "parts of the stamps that are kept"},
    {"faintest", "3.2", 1, 1e6, false, "signal-to-noise of the faintest galaxies, as in GREAT3"},
    {"range", "10", 1, 1e6, false, "largest over smallest; even in the logarithm between"},
    {"aperture", "3", 0.5, 20, false, "sigma of the round Gaussian aperture, pixels"},
    {0}};

static void defaults(struct request *r) {
    (void)shear_settings_set(&r->settings, "preset", "default", NULL);
    r->mock.g1 = 0.08;
    r->mock.g2 = -0.05;
    r->galaxies = 160000;
    r->groups = 160;
}

/* ---- drawing and measuring, once ---- */

struct stamp {
    shear_row row;
    double value[N_CUTS];
};

struct run {
    const struct request *request;
    struct trial trial;
    struct studio *studio;
    struct stamp *stamps; /* [2][trial.stamps]: +g, -g */
    shear_row *rows;      /* of a group */
    double *aperture;     /* [side][side] */
    double aperture_noise;
    double beta_px;
    char path[SCRATCH_PATH];
};

static int64_t begin_of(const struct run *run, int group) {
    const struct trial *t = &run->trial;
    return t->stamps / t->copies * group / t->groups * t->copies;
}

/* A round Gaussian about the stamp's centre, and what noise of 1 a pixel scatters its sum by. */
static void fill_aperture(struct run *run) {
    const int side = run->trial.flaw->side;
    const double sigma = request_number(run->request, "aperture");
    double square = 0.0;
    for (int i = 0; i < side * side; i++) {
        const double x = i % side - 0.5 * (side - 1);
        const double y = (double)(i / side) - 0.5 * (side - 1);
        run->aperture[i] = exp(-0.5 * (x * x + y * y) / (sigma * sigma));
        square += run->aperture[i] * run->aperture[i];
    }
    run->aperture_noise = sqrt(square);
}

static double aperture_snr(const struct run *run, const double *image) {
    double sum = 0.0;
    for (int i = 0; i < run->trial.flaw->side * run->trial.flaw->side; i++) {
        sum += run->aperture[i] * image[i];
    }
    return sum / run->aperture_noise;
}

static void take(const struct run *run, int k, int sign, struct stamp *s) {
    const studio_view view = studio_look(run->studio, sign);
    const int side = run->trial.flaw->side;
    const size_t at = (size_t)k * (size_t)side * (size_t)side;
    const double snr = studio_snr(run->studio, &run->trial.levels[0], k);
    s->row = run->rows[k];
    s->value[CUT_TRUE] = snr;
    s->value[CUT_FLUX] = s->row.flux;
    s->value[CUT_SNR] = s->row.snr;
    s->value[CUT_APERTURE] = aperture_snr(run, view.galaxy + at);
    s->value[CUT_DEEP] = snr * aperture_snr(run, view.bare + at);
    s->value[CUT_D] = s->row.d;
}

/* The plan that a user's file would have; the stamps as they were before they were written. */
static int measure(struct run *run, int sign, int count, shear_error *err) {
    const studio_view view = studio_look(run->studio, sign);
    const int side = run->trial.flaw->side;
    const shear_stamps stamps = {
        .count = count, .nx = side, .ny = side, .galaxy = view.galaxy, .noise = view.noise};
    shear_field *field = NULL;
    shear_plan *plan = NULL;
    int code = shear_field_open(&field, run->path, err);
    code =
        code != SHEAR_OK ? code : shear_plan_for_field(&plan, &run->request->settings, field, err);
    if (code == SHEAR_OK) {
        run->beta_px = shear_plan_get_info(plan)->beta_px;
        code = shear_measure_batch(plan, &stamps, run->trial.threads, NULL, run->rows, err);
    }
    shear_plan_free(plan);
    shear_field_close(field);
    return code;
}

static int do_group(struct run *run, int group, shear_error *err) {
    const int64_t first = begin_of(run, group);
    const int count = (int)(begin_of(run, group + 1) - first);
    int code = studio_draw(run->studio, first, count, err);
    for (int sign = 0; code == SHEAR_OK && sign < 2; sign++) {
        code = studio_write(run->studio, &run->trial.levels[0], sign, run->path, err);
        code = code != SHEAR_OK ? code : measure(run, sign, count, err);
        for (int k = 0; code == SHEAR_OK && k < count; k++) {
            take(run, k, sign, &run->stamps[sign * run->trial.stamps + first + k]);
        }
    }
    return code;
}

/* ---- cutting ---- */

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The value that a part `kept` of the unflagged stamps of both signs reaches. */
static int find_threshold(const struct run *run, int cut, double kept, double *threshold,
                          shear_error *err) {
    const size_t all = 2 * (size_t)run->trial.stamps;
    int code = SHEAR_OK;
    size_t n = 0;
    double *v = memory_new(all, sizeof *v, "a cut", &code, err);
    for (size_t i = 0; code == SHEAR_OK && i < all; i++) {
        if (run->stamps[i].row.flags == 0) {
            v[n++] = run->stamps[i].value[cut];
        }
    }
    *threshold = -INFINITY;
    if (n > 0) {
        qsort(v, n, sizeof *v, compare);
        *threshold = v[(size_t)fmin((1.0 - kept) * (double)n, (double)n - 1.0)];
    }
    free(v);
    return code;
}

struct cut {
    int on; /* enum selection_cut */
    double threshold;
};

/* The stamps [from, to) that are kept, in the library's blocks. *n += how many there are. */
static int gather(const struct run *run, struct cut cut, const int64_t range[2],
                  shear_field_sums *sums, shear_symmetry *terms, double *n, shear_error *err) {
    int code = SHEAR_OK;
    for (int64_t block = range[0]; code == SHEAR_OK && block < range[1]; block += SHEAR_BLOCK) {
        shear_block_sums b;
        shear_block_sums_init(&b);
        for (int64_t i = block; code == SHEAR_OK && i < block + SHEAR_BLOCK && i < range[1]; i++) {
            const struct stamp *s = &run->stamps[i];
            if (s->value[cut.on] >= cut.threshold) {
                shear_block_sums_add(&b, &s->row);
                code = terms != NULL ? shear_symmetry_add(terms, &s->row, run->beta_px, err)
                                     : SHEAR_OK;
            }
        }
        *n += (double)b.n_used;
        shear_field_sums_add(sums, &b);
    }
    return code;
}

/* What is left by a cut, of all groups at both signs. */
static int harvest_cut(const struct run *run, struct cut cut, enum shear_estimator estimator,
                       harvest *h, double *kept, shear_error *err) {
    const struct trial *t = &run->trial;
    double n = 0.0;
    int code = harvest_init(h, t->groups, estimator, err);
    for (int at = 0; code == SHEAR_OK && at < 2 * t->groups; at++) {
        const int64_t from = at / t->groups * t->stamps;
        const int64_t range[] = {from + begin_of(run, at % t->groups),
                                 from + begin_of(run, at % t->groups + 1)};
        code = gather(run, cut, range, h->sums[at], h->terms[at], &n, err);
    }
    *kept = n / (2.0 * (double)t->stamps);
    return code;
}

static int judge(const struct run *run, struct cut cut, enum shear_estimator estimator,
                 const harvest *reference, selection_outcome *out, shear_error *err) {
    harvest h;
    trial_outcome o = {0};
    int code = harvest_cut(run, cut, estimator, &h, &out->kept, err);
    code = code != SHEAR_OK ? code : harvest_judge(&h, &run->trial, &o, err);
    code = code != SHEAR_OK
               ? code
               : harvest_shift(&h, reference, &run->trial, &out->shift, &out->shift_err, err);
    harvest_deinit(&h);
    out->m = o.m;
    out->m_err = o.m_err;
    out->threshold = cut.threshold;
    return code;
}

static int cut_all(const struct run *run, selection_outcome *out, shear_error *err) {
    const knob_values *kept = request_list(run->request, "kept");
    const struct cut none = {CUT_TRUE, -INFINITY};
    int code = SHEAR_OK;
    for (int e = 0; code == SHEAR_OK && e < SELECTION_ESTIMATORS; e++) {
        harvest reference;
        double all;
        code = harvest_cut(run, none, estimators[e], &reference, &all, err);
        for (int i = 0; code == SHEAR_OK && i < N_CUTS * kept->n; i++) {
            struct cut cut = {.on = i / kept->n};
            code = find_threshold(run, cut.on, kept->v[i % kept->n], &cut.threshold, err);
            code = code != SHEAR_OK ? code
                                    : judge(run, cut, estimators[e], &reference,
                                            &out[i * SELECTION_ESTIMATORS + e], err);
        }
        harvest_deinit(&reference);
    }
    return code;
}

/* ---- all ---- */

static int prepare(struct run *run, shear_error *err) {
    const struct request *r = run->request;
    struct trial *t = &run->trial;
    int code = SHEAR_OK;
    *t = (struct trial){.flaw = &flaws[0],
                        .seed = r->mock.seed,
                        .stamps = r->galaxies / 4 * 4,
                        .groups = r->groups,
                        .threads = r->threads,
                        .copies = 4,
                        .g = {r->mock.g1, r->mock.g2},
                        .n_levels = 1,
                        .levels = {{.snr = request_number(r, "faintest"),
                                    .range = request_number(r, "range"),
                                    .slope = 1.0}}};
    if (t->groups < 2 || t->stamps / t->copies < t->groups) {
        return shear_fail(err, SHEAR_E_SETTING, "ask for more galaxies",
                          "%lld stamps are too few for %d groups", (long long)t->stamps, t->groups);
    }
    const int64_t most = (t->stamps / t->copies / t->groups + 1) * t->copies;
    run->stamps = memory_new(2 * (size_t)t->stamps, sizeof *run->stamps, "stamps", &code, err);
    run->rows = memory_new((size_t)most, sizeof *run->rows, "rows", &code, err);
    run->aperture =
        memory_new((size_t)(t->flaw->side * t->flaw->side), sizeof(double), "pixels", &code, err);
    if (code == SHEAR_OK) {
        fill_aperture(run);
    }
    code = code != SHEAR_OK ? code : studio_new(&run->studio, t, (int)most, err);
    return code != SHEAR_OK ? code : scratch_new(run->path, err);
}

static int work(void *context, int chunk, double *values, shear_error *err) {
    struct run run = {.request = context};
    (void)chunk;
    int code = prepare(&run, err);
    for (int group = 0; code == SHEAR_OK && group < run.trial.groups; group++) {
        code = do_group(&run, group, err);
    }
    code = code != SHEAR_OK ? code : cut_all(&run, (selection_outcome *)values, err);
    free(run.stamps);
    free(run.rows);
    free(run.aperture);
    studio_free(run.studio);
    scratch_free(run.path);
    return code;
}

static int exec(const struct request *r, shear_error *err) {
    const int n = N_CUTS * request_list(r, "kept")->n * SELECTION_ESTIMATORS;
    struct request copy = *r;
    struct ledger *ledger = NULL;
    const struct task task = {.name = "galaxies",
                              .chunks = 1,
                              .values = n * SELECTION_VALUES,
                              .stamps_of_chunk = 2 * r->galaxies,
                              .work = work,
                              .context = &copy};
    int code = ledger_open(&ledger, r, 2 * r->galaxies, err);
    selection_outcome *out = memory_new((size_t)n, sizeof *out, "results", &code, err);
    code = code != SHEAR_OK ? code : ledger_run(ledger, &task, (double *)out, err);
    code = code != SHEAR_OK ? code : selection_report(r, ledger, out, err);
    ledger_close(ledger);
    free(out);
    return code;
}

const experiment exp_selection = {
    .name = "selection",
    .summary = "beyond the paper: what cuts on signal-to-noise do to the shear",
    .about =
        "Galaxies of disk and bulge in fours behind a Moffat PSF, at +g and -g in the same noise,\n"
        "of a signal-to-noise that is even in the logarithm: measured once by the default\n"
        "settings, then cut on what is true of them, on columns of the result and on aperture\n"
        "fluxes. m of the mean and of pdf-sym, less that without a cut, against the part kept.",
    .knobs = knobs,
    .fixed = trial_fixed,
    .defaults = defaults,
    .exec = exec,
};
