/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Experiment `selection` (beyond the paper): the effect of a cut on the shear, for several
 * quantities. */
#include "base/sort.h"
#include "engine/must.h"
#include "engine/scratch.h"
#include "engine/trial_stamps.h"
#include "engine/trial_sums.h"
#include "experiments/list.h"
#include "report/run.h"
#include "shear/run.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

/* The quantity of the cut, in the order of the figure. */
enum cut_on {
    CUT_TRUE, /* the signal-to-noise of the unsheared galaxy */
    CUT_FLUX, /* FLUX, SNR and D of the result */
    CUT_SNR,
    CUT_APERTURE, /* flux in a round Gaussian aperture at the stamp's centre, over its noise */
    CUT_DEEP,     /* the same in the image without noise */
    CUT_D,
    N_CUTS
};
static const char *const cut_names[N_CUTS] = {"true S/N",     "FLUX",          "SNR",
                                              "aperture S/N", "deep aperture", "D"};
enum { N_ESTIMATORS = 2 };
static const char *const estimator_names[N_ESTIMATORS] = {"mean", "pdf-sym"};
static const enum shear_estimator estimators[N_ESTIMATORS] = {SHEAR_ESTIMATOR_MEAN,
                                                              SHEAR_ESTIMATOR_PDF_SYM};

static const parameter parameters[] = {
    {"kept", "1,0.9,0.8,0.7,0.6,0.5,0.4,0.3", 0.05, 1, MAX_VALUES,
     "parts of the stamps that are kept"},
    {"faintest", "3.2", 1, 1e6, 1, "signal-to-noise of the faintest galaxies, as in GREAT3"},
    {"range", "10", 1, 1e6, 1, "largest over smallest; even in the logarithm between"},
    {"aperture", "3", 0.5, 20, 1, "sigma of the round Gaussian aperture, pixels"},
    {0}};

static int64_t stamps(const options *o) {
    return 2 * o->galaxies;
}

/* The results, only doubles, for the result cache: [N_CUTS][kept][N_ESTIMATORS]. */
typedef struct outcome {
    double m, m_err;
    double shift, shift_err; /* m minus m without a cut */
    double kept, threshold;  /* fraction of the stamps; smallest value that is kept */
} outcome;
enum { OUTCOME_VALUES = sizeof(outcome) / sizeof(double) };

/* ---- drawing and measuring, once ---- */

typedef struct stamp {
    shear_row row;
    double value[N_CUTS];
} stamp;

typedef struct measuring {
    const options *options;
    trial trial;
    trial_stamps *drawn;
    int side;
    stamp *stamps;    /* [2][trial.stamps]: +g, -g */
    shear_row *rows;  /* of one group */
    double *aperture; /* [side][side] */
    double aperture_noise;
    double beta_px;
} measuring;

/* Fill a round Gaussian aperture at the stamp's centre, and the scatter of its sum for noise of 1
 * per pixel. */
static void fill_aperture(measuring *m) {
    const double sigma = options_number(m->options, "aperture");
    double square = 0.0;
    for (int i = 0; i < m->side * m->side; i++) {
        const double x = i % m->side - 0.5 * (m->side - 1);
        const double y = (double)(i / m->side) - 0.5 * (m->side - 1);
        m->aperture[i] = exp(-0.5 * (x * x + y * y) / (sigma * sigma));
        square += m->aperture[i] * m->aperture[i];
    }
    m->aperture_noise = sqrt(square);
}

static double aperture_snr(const measuring *m, const double *image) {
    double sum = 0.0;
    for (int i = 0; i < m->side * m->side; i++)
        sum += m->aperture[i] * image[i];
    return sum / m->aperture_noise;
}

static void keep_stamp(const measuring *m, int k, int sign, stamp *s) {
    const trial_stamps_view view = trial_stamps_look(m->drawn, sign);
    const size_t at = (size_t)k * (size_t)m->side * (size_t)m->side;
    const double snr = trial_stamps_snr(m->drawn, &m->trial.levels[0], k);
    s->row = m->rows[k];
    s->value[CUT_TRUE] = snr;
    s->value[CUT_FLUX] = s->row.flux;
    s->value[CUT_SNR] = s->row.snr;
    s->value[CUT_APERTURE] = aperture_snr(m, view.galaxy + at);
    s->value[CUT_DEEP] = snr * aperture_snr(m, view.bare + at);
    s->value[CUT_D] = s->row.d;
}

/* Measure with the plan that a file of these stamps would have, but with the stamps as drawn. */
static void measure(measuring *m, int sign, int count) {
    const trial_stamps_view view = trial_stamps_look(m->drawn, sign);
    const shear_stamps pairs = {
        .count = count, .nx = m->side, .ny = m->side, .galaxy = view.galaxy, .noise = view.noise};
    shear_field *field = NULL;
    shear_plan *plan = NULL;
    must(shear_field_open(&field, scratch_path(), &must_error));
    must(shear_plan_for_field(&plan, &m->options->settings, field, &must_error));
    m->beta_px = shear_plan_get_info(plan)->beta_px;
    must(shear_measure_batch(plan, &pairs, m->trial.threads, NULL, m->rows, &must_error));
    shear_plan_free(plan);
    shear_field_close(field);
}

static void do_group(measuring *m, int group) {
    const trial *t = &m->trial;
    const int64_t first = trial_begin(t, group);
    const int count = (int)(trial_begin(t, group + 1) - first);
    trial_stamps_draw(m->drawn, first, count);
    for (int sign = 0; sign < 2; sign++) {
        trial_stamps_write(m->drawn, &t->levels[0], sign, scratch_path());
        measure(m, sign, count);
        for (int k = 0; k < count; k++)
            keep_stamp(m, k, sign, &m->stamps[sign * t->stamps + first + k]);
    }
}

/* ---- cutting ---- */

typedef struct cut {
    enum cut_on on;
    double threshold;
} cut;

/* Find the value that a fraction `kept` of the unflagged stamps of both signs reaches. */
static cut find_cut(const measuring *m, enum cut_on on, double kept) {
    const size_t all = 2 * (size_t)m->trial.stamps;
    cut found = {on, -INFINITY};
    size_t n = 0;
    CLEANUP(release_free) double *v = must_allocate(all, sizeof *v, "a cut");
    for (size_t i = 0; i < all; i++) {
        if (m->stamps[i].row.flags == 0)
            v[n++] = m->stamps[i].value[on];
    }
    if (n > 0) {
        sort_doubles(v, n);
        found.threshold = v[(size_t)fmin((1.0 - kept) * (double)n, (double)n - 1.0)];
    }
    return found;
}

/* Add the kept stamps of [from, to) in the library's blocks. Returns their number. */
static double gather(const measuring *m, cut c, int64_t from, int64_t to, shear_field_sums *sums,
                     shear_symmetry *terms) {
    double n = 0.0;
    for (int64_t block = from; block < to; block += SHEAR_BLOCK) {
        shear_block_sums b;
        shear_block_sums_init(&b);
        for (int64_t i = block; i < block + SHEAR_BLOCK && i < to; i++) {
            const stamp *s = &m->stamps[i];
            if (!(s->value[c.on] >= c.threshold))
                continue;
            shear_block_sums_add(&b, &s->row);
            if (terms != NULL)
                must(shear_symmetry_add(terms, &s->row, m->beta_px, &must_error));
        }
        n += (double)b.n_used;
        shear_field_sums_add(sums, &b);
    }
    return n;
}

/* Sum the kept stamps of all groups at both signs. */
static trial_sums *sum_kept(const measuring *m, cut c, enum shear_estimator estimator,
                            double *kept) {
    const trial *t = &m->trial;
    trial_sums *sums = trial_sums_new(t->groups, estimator);
    double n = 0.0;
    for (int i = 0; i < 2 * t->groups; i++) {
        const int sign = i / t->groups;
        const int group = i % t->groups;
        n += gather(m, c, sign * t->stamps + trial_begin(t, group),
                    sign * t->stamps + trial_begin(t, group + 1), sums->sums[i], sums->terms[i]);
    }
    *kept = n / (2.0 * (double)t->stamps);
    return sums;
}

static outcome outcome_of(const measuring *m, cut c, enum shear_estimator estimator,
                          const trial_sums *reference) {
    outcome out = {.threshold = c.threshold};
    trial_outcome o = {0};
    trial_sums *sums = sum_kept(m, c, estimator, &out.kept);
    trial_sums_conclude(sums, &m->trial, &o);
    trial_sums_shift(sums, reference, &m->trial, &out.shift, &out.shift_err);
    trial_sums_free(sums);
    out.m = o.m;
    out.m_err = o.m_err;
    return out;
}

static void cut_all(const measuring *m, outcome *out) {
    const parameter_values *kept = options_list(m->options, "kept");
    for (int e = 0; e < N_ESTIMATORS; e++) {
        double all = 0.0;
        trial_sums *reference = sum_kept(m, (cut){CUT_TRUE, -INFINITY}, estimators[e], &all);
        for (int i = 0; i < N_CUTS * kept->n; i++) {
            const cut c = find_cut(m, (enum cut_on)(i / kept->n), kept->v[i % kept->n]);
            out[i * N_ESTIMATORS + e] = outcome_of(m, c, estimators[e], reference);
        }
        trial_sums_free(reference);
    }
}

static void prepare(measuring *m, const options *o) {
    trial *t = &m->trial;
    *m = (measuring){.options = o, .trial = trial_of_options(o, 4)};
    t->stamps = o->galaxies / 4 * 4;
    t->n_levels = 1;
    t->levels[0] = (trial_level){options_number(o, "faintest"), options_number(o, "range"), 1.0};
    if (t->groups < 2 || t->stamps / t->copies < t->groups) {
        must_fail(SHEAR_E_SETTING, "ask for more galaxies", "%lld stamps are too few for %d groups",
                  (long long)t->stamps, t->groups);
    }
    const int64_t most = (t->stamps / t->copies / t->groups + 1) * t->copies;
    m->side = t->flaw->side;
    m->drawn = trial_stamps_new(t, (int)most);
    m->stamps = must_allocate(2 * (size_t)t->stamps, sizeof *m->stamps, "stamps");
    m->rows = must_allocate((size_t)most, sizeof *m->rows, "rows");
    m->aperture = must_allocate((size_t)m->side * (size_t)m->side, sizeof *m->aperture, "pixels");
    fill_aperture(m);
}

static void work(void *context, int chunk, double *values) {
    measuring m;
    assert(chunk == 0);
    (void)chunk;
    prepare(&m, *(const options *const *)context);
    for (int group = 0; group < m.trial.groups; group++)
        do_group(&m, group);
    cut_all(&m, (outcome *)values);
    free(m.stamps);
    free(m.rows);
    free(m.aperture);
    trial_stamps_free(m.drawn);
}

/* ---- table ---- */

static const column columns[] = {
    {"cut", TABLE_TEXT, 0, .help = "what is cut on"},
    {"asked", TABLE_NUMBER, 2, .help = "part of the stamps that is to be kept"},
    {"kept", TABLE_NUMBER, 3, .help = "part that is"},
    {"threshold", TABLE_NUMBER, -4, .help = "the least value that is kept"},
    {"estimator", TABLE_TEXT, 0, .help = "mean or pdf-sym"},
    {"m", TABLE_NUMBER, 4, .help = "multiplicative bias along the shear", .with_error = true},
    {"shift", TABLE_NUMBER, 4, .help = "m less that without a cut", .with_error = true},
    {0}};

/* Add a conclusion for the fraction nearest to a half. `out` is [kept][N_ESTIMATORS]. */
static void conclude(table *t, const parameter_values *kept, const outcome *out, int i_cut) {
    int half = 0;
    for (int i = 1; i < kept->n; i++)
        half = fabs(kept->v[i] - 0.5) < fabs(kept->v[half] - 0.5) ? i : half;
    const outcome *mean = &out[half * N_ESTIMATORS];
    const outcome *pdf = mean + 1;
    table_meta(t, TABLE_CONCLUSION,
               "%s, %.2f of the stamps kept: m changes by %+.1f +- %.1f (mean), %+.1f +- %.1f "
               "(pdf-sym), 10^-3",
               cut_names[i_cut], mean->kept, 1e3 * mean->shift, 1e3 * mean->shift_err,
               1e3 * pdf->shift, 1e3 * pdf->shift_err);
}

static void tabulate(table *t, const parameter_values *kept, const outcome *out) {
    const int n = kept->n * N_ESTIMATORS;
    table_columns(t, columns);
    for (int i = 0; i < N_CUTS * n; i++) {
        const outcome *o = &out[i];
        table_texts(t, cut_names[i / n]);
        table_numbers(t, kept->v[i % n / N_ESTIMATORS], o->kept, o->threshold);
        table_texts(t, estimator_names[i % N_ESTIMATORS]);
        table_numbers(t, o->m, o->m_err, o->shift, o->shift_err);
    }
    for (int i = 0; i < N_CUTS; i++)
        conclude(t, kept, out + i * n, i);
}

/* ---- figure: a panel per estimator ---- */

static void draw_panel(const panels *p, int n_kept, const outcome *out, int estimator) {
    curve curves[N_CUTS] = {{.hue = SHEAR_BLACK, .marker = SHEAR_DISC},
                            {.hue = SHEAR_BLUE, .marker = SHEAR_SQUARE},
                            {.hue = SHEAR_SKY, .marker = SHEAR_TRIANGLE},
                            {.hue = SHEAR_GREEN, .marker = SHEAR_DISC},
                            {.hue = SHEAR_PURPLE, .marker = SHEAR_CIRCLE},
                            {.hue = SHEAR_VERMILION, .marker = SHEAR_CROSS}};
    for (int i = 0; i < N_CUTS * n_kept; i++) {
        const outcome *o = &out[i * N_ESTIMATORS + estimator];
        curves[i / n_kept].label = cut_names[i / n_kept];
        curve_add(&curves[i / n_kept], o->kept, 1e3 * o->shift, 1e3 * o->shift_err);
    }
    panels_draw(p, estimator,
                &(chart){estimator_names[estimator], "part of the stamps that is kept",
                         "m less that without a cut, 10^{-3}", .legend = SHEAR_TOP_RIGHT,
                         .truth = 0.0, .headroom = 0.45, .spread = 0.008, .n_curves = N_CUTS,
                         .curves = curves});
}

static void run_selection(run *r) {
    const options *o = r->options;
    const parameter_values *kept = options_list(o, "kept");
    CLEANUP(release_free)
    outcome *out = (outcome *)cache_run(
        r->cache,
        &(cache_task){"galaxies", 1, .values = N_CUTS * kept->n * N_ESTIMATORS * OUTCOME_VALUES,
                      .stamps_of_chunk = 2 * o->galaxies, .work = work, .context = &o});
    tabulate(r->table, kept, out);
    const panels p =
        run_panels(r, NULL, 1000, 440, (shear_grid){.rows = 1, .columns = 2, .gap_x = 12});
    for (int i = 0; i < N_ESTIMATORS; i++)
        draw_panel(&p, kept->n, out, i);
}

const experiment experiment_selection = {
    "selection",
    "beyond the paper: what cuts on signal-to-noise do to the shear",
    "Galaxies of disk and bulge in fours behind a Moffat PSF, at +g and -g in the same noise,\n"
    "of a signal-to-noise that is even in the logarithm: measured once by the default\n"
    "settings, then cut on what is true of them, on columns of the result and on aperture\n"
    "fluxes. m of the mean and of pdf-sym, less that without a cut, against the part kept.",
    .defaults = "preset=default shear=0.08,-0.05 galaxies=160000 groups=160",
    .fixed = trial_fixed,
    .parameters = parameters,
    .stamps = stamps,
    .run = run_selection};
