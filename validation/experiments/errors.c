/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Experiment `errors` (beyond the paper): whether the quoted errors are correct. Pulls of many
 * fields of several lengths, by the delta method and by the jackknife. */
#include "engine/must.h"
#include "engine/sample.h"
#include "experiments/list.h"
#include "report/run.h"

#include <math.h>
#include <stdlib.h>

enum { N_WAYS = 2, PER_FIELD = 6, BINS = 60 };

static const parameter parameters[] = {
    {"lengths", "50,100,200,500,1000,2000", 20, 1e5, MAX_VALUES,
     "galaxies in a field; each divides the last"},
    {"pictured", "500", 20, 1e5, 1, "the length whose pulls are drawn"},
    {"jackknife", "50", 2, 1e5, 1, "groups of the jackknife, where a field has so many blocks"},
    {0}};

static const char *const ways[N_WAYS] = {"delta", "jackknife"};

/* ---- fields: a chunk is one field of the longest length, or several shorter ones ---- */

static int length_of(const options *o, int k) {
    return (int)options_list(o, "lengths")->v[k];
}

static int chunk_length(const options *o) {
    return length_of(o, options_list(o, "lengths")->n - 1);
}

static int chunks_of(const options *o) {
    return (int)(o->galaxies / chunk_length(o));
}

static int fields_of_chunk(const options *o, int k) {
    return chunk_length(o) / length_of(o, k);
}

/* Return the number of values for the first n lengths. */
static int values_of_chunk(const options *o, int n) {
    int fields = 0;
    for (int k = 0; k < n; k++)
        fields += fields_of_chunk(o, k);
    return fields * PER_FIELD;
}

/* Return the number of jackknife groups, at most the number of blocks. */
static int jackknife_groups(const options *o, int length) {
    const int blocks = (length + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
    return (int)fmin(options_number(o, "jackknife"), blocks);
}

static int64_t stamps(const options *o) {
    const parameter_values *lengths = options_list(o, "lengths");
    const double last = lengths->v[lengths->n - 1];
    for (int k = 0; k < lengths->n; k++) {
        if (fmod(last, lengths->v[k]) != 0.0 || lengths->v[k] != floor(lengths->v[k])) {
            must_fail(SHEAR_E_SETTING, NULL, "option '--lengths': %g does not divide the last, %g",
                      lengths->v[k], last);
        }
    }
    if (o->galaxies < 4 * chunk_length(o)) {
        must_fail(SHEAR_E_SETTING, NULL, "option '--galaxies': at least %d for these lengths",
                  4 * chunk_length(o));
    }
    return (int64_t)chunks_of(o) * chunk_length(o);
}

/* Measure one field: g1, g2, errors of the delta method, errors of the jackknife. */
static void measure_field(const shear_row *rows, int n, int groups, double out[PER_FIELD]) {
    const int n_blocks = (n + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
    CLEANUP(release_free)
    shear_block_sums *blocks = must_allocate((size_t)n_blocks, sizeof *blocks, "sums");
    for (int i = 0; i < n; i++) {
        if (i % SHEAR_BLOCK == 0)
            shear_block_sums_init(&blocks[i / SHEAR_BLOCK]);
        shear_block_sums_add(&blocks[i / SHEAR_BLOCK], &rows[i]);
    }
    const shear_result delta = jackknife_result(blocks, n_blocks, 0);
    const shear_result jackknife = jackknife_result(blocks, n_blocks, groups);
    out[0] = delta.g1;
    out[1] = delta.g2;
    out[2] = delta.g1_err;
    out[3] = delta.g2_err;
    out[4] = jackknife.g1_err;
    out[5] = jackknife.g2_err;
}

typedef struct chunked {
    const options *options;
    sampler *sampler;
    shear_row *rows; /* [chunk_length] */
} chunked;

static void measure_chunk(void *context, int chunk, double *values) {
    const chunked *of = context;
    const options *o = of->options;
    const int length = chunk_length(o);
    sampler_rows(of->sampler, (int64_t)chunk * length, length, of->rows);
    for (int k = 0; k < options_list(o, "lengths")->n; k++) {
        const int n = length_of(o, k);
        for (int i = 0; i < fields_of_chunk(o, k); i++, values += PER_FIELD)
            measure_field(of->rows + i * n, n, jackknife_groups(o, n), values);
    }
}

/* Return values [chunks][values_of_chunk]. */
static double *measure(const options *o, cache *c) {
    const sample what = {"fields", .n_scenes = 1, .scenes = {{.spec = o->mock}}, .n_series = 1,
                         .series = {{.settings = o->settings}}};
    const int length = chunk_length(o);
    chunked of = {o, sampler_new(&what, (int64_t)chunks_of(o) * length, o->threads),
                  must_allocate((size_t)length, sizeof *of.rows, "rows")};
    double *values = cache_run(
        c, &(cache_task){"fields", chunks_of(o),
                         .values = values_of_chunk(o, options_list(o, "lengths")->n),
                         .stamps_of_chunk = length, .work = measure_chunk, .context = &of});
    sampler_free(of.sampler);
    free(of.rows);
    return values;
}

/* ---- pulls ---- */

/* Collect the pulls of all fields of one length, for both components: pulls [2 chunks
 * fields_of_chunk]. Returns their number. */
static size_t collect(const options *o, const double *values, int k, int way, double *pulls) {
    const int of_chunk = values_of_chunk(o, options_list(o, "lengths")->n);
    size_t n = 0;
    for (int chunk = 0; chunk < chunks_of(o); chunk++) {
        const double *v = values + (size_t)chunk * (size_t)of_chunk + values_of_chunk(o, k);
        for (int i = 0; i < fields_of_chunk(o, k); i++, v += PER_FIELD) {
            pulls[n++] = (v[0] - o->mock.g1) / v[2 + 2 * way];
            pulls[n++] = (v[1] - o->mock.g2) / v[3 + 2 * way];
        }
    }
    return n;
}

typedef struct outcome {
    curve width[N_WAYS];
    double counts[N_WAYS][BINS];
    double from[N_WAYS]; /* in galaxies; NaN: none */
    size_t pictured;     /* pulls in the histogram */
} outcome;

static const shear_range drawn = {-4.5, 4.5};
static const double tolerance = 0.03;

static const column columns[] = {
    {"n", TABLE_INTEGER, 0, .help = "galaxies in a field"},
    {"errors", TABLE_TEXT, 0, .help = "delta method or jackknife"},
    {"groups", TABLE_INTEGER, 0, .help = "of the jackknife"},
    {"pulls", TABLE_INTEGER, 0, .help = "fields times two components"},
    {"mean", TABLE_NUMBER, 4, .help = "of (measured - true) / quoted error", .with_error = true},
    {"width", TABLE_NUMBER, 4, .help = "standard deviation of the pulls", .with_error = true},
    {"ks", TABLE_NUMBER, 4, .help = "Kolmogorov-Smirnov distance from a unit Gaussian"},
    {"p_gauss", TABLE_NUMBER, -3, .help = "its probability"},
    {"p_student", TABLE_NUMBER, -3,
     .help = "probability of the distance from Student's t with as many degrees of freedom as the "
             "error is "
             "known with (groups - 1)"},
    {0}};

static void add_row(run *r, int length, int way, double *pulls, size_t n, outcome *out) {
    const int groups = jackknife_groups(r->options, length);
    const spread s = spread_of(pulls, n);
    double p_gauss, p_student;
    if (length == (int)options_number(r->options, "pictured")) {
        shear_histogram(out->counts[way], BINS, drawn, pulls, n);
        out->pictured = n;
    }
    const double ks = ks_distance(pulls, n, 0.0, &p_gauss);
    ks_distance(pulls, n, way != 0 ? groups - 1.0 : length - 1.0, &p_student);
    table_numbers(r->table, length);
    table_texts(r->table, ways[way]);
    table_numbers(r->table, way != 0 ? (double)groups : NAN, (double)n, s.mean, s.mean_err, s.width,
                  s.width_err, ks, p_gauss, p_student);
    curve_add(&out->width[way], length, s.width, s.width_err);
    if (fabs(s.width - 1.0) > tolerance + s.width_err) {
        out->from[way] = NAN;
    } else if (isnan(out->from[way])) {
        out->from[way] = length;
    }
}

static void conclude(table *t, const outcome *out, int way) {
    if (isnan(out->from[way])) {
        table_meta(t, TABLE_CONCLUSION, "%s: no length has a width within %.0f %% of 1", ways[way],
                   100.0 * tolerance);
    } else {
        table_meta(t, TABLE_CONCLUSION,
                   "%s: the pulls' width is within %.0f %% (and its own error) of 1 from %.0f "
                   "galaxies on",
                   ways[way], 100.0 * tolerance, out->from[way]);
    }
}

static void tabulate(run *r, const double *values, outcome *out) {
    const options *o = r->options;
    const int of_chunk = values_of_chunk(o, options_list(o, "lengths")->n);
    CLEANUP(release_free)
    double *pulls = must_allocate((size_t)chunks_of(o), (size_t)of_chunk * sizeof *pulls, "pulls");
    table_columns(r->table, columns);
    out->from[0] = out->from[1] = NAN;
    for (int i = 0; i < options_list(o, "lengths")->n * N_WAYS; i++) {
        const size_t n = collect(o, values, i / N_WAYS, i % N_WAYS, pulls);
        add_row(r, length_of(o, i / N_WAYS), i % N_WAYS, pulls, n, out);
    }
    conclude(r->table, out, 0);
    conclude(r->table, out, 1);
}

/* ---- figure ---- */

static void draw_pulls(shear_figure *f, shear_rect cell, const options *o, const outcome *out) {
    double x[BINS], y[BINS];
    char title[48];
    const double width = (drawn.hi - drawn.lo) / BINS;
    double top = 1.0;
    for (int i = 0; i < BINS; i++) {
        x[i] = drawn.lo + (i + 0.5) * width;
        y[i] = (double)out->pictured * width * exp(-0.5 * x[i] * x[i]) / sqrt(2.0 * M_PI);
        top = fmax(top, fmax(y[i], fmax(out->counts[0][i], out->counts[1][i])));
    }
    snprintf(title, sizeof title, "fields of %.0f galaxies", options_number(o, "pictured"));
    shear_axes_begin(f,
                     &(shear_axes){cell, title, .x = {drawn, .label = "(measured - true) / error"},
                                   .y = {{0.0, 1.3 * top}, .label = "pulls"}});
    shear_axes_histogram(
        f, BINS, drawn, out->counts[0],
        &(shear_style){.colour = shear_palette(SHEAR_BLUE), .fill = 0.2, .label = "delta method"});
    shear_axes_histogram(
        f, BINS, drawn, out->counts[1],
        &(shear_style){.colour = shear_palette(SHEAR_VERMILION), .label = "jackknife"});
    shear_axes_line(f, BINS, x, y, &(shear_style){.dash = SHEAR_DASHED, .label = "unit Gaussian"});
    shear_axes_end(f);
}

static void run_errors(run *r) {
    static outcome out = {.width = {{"delta method", SHEAR_BLUE, .marker = SHEAR_DISC},
                                    {"jackknife", SHEAR_VERMILION, .marker = SHEAR_SQUARE}}};
    CLEANUP(release_free) double *values = measure(r->options, r->cache);
    tabulate(r, values, &out);
    const panels p =
        run_panels(r, NULL, 940, 400, (shear_grid){.rows = 1, .columns = 2, .gap_x = 12});
    draw_pulls(p.figure, panels_cell(&p, 0), r->options, &out);
    panels_draw(&p, 1,
                &(chart){"width of the pulls", "galaxies in a field", "standard deviation",
                         .log_x = true, .truth = 1.0, .spread = 0.012, .n_curves = N_WAYS,
                         .curves = out.width});
}

const experiment experiment_errors = {
    "errors",
    "beyond the paper: are the quoted errors honest?",
    "Fields of unpaired regular galaxies in white noise: 2000 of 500 galaxies, and the same\n"
    "galaxies cut into shorter and longer fields. The pulls, (measured - true) / quoted\n"
    "error, of the delta method and of the jackknife: mean, width, Kolmogorov-Smirnov.",
    .defaults =
        "rotate=1 size=48 points=100 white=0.5 filter=none interpolation=none galaxies=1000000",
    .fixed = "rotate groups",
    .parameters = parameters,
    .stamps = stamps,
    .run = run_errors};
