/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beyond the paper: are the quoted errors honest? Pulls of many fields, by the delta method and by
 * the jackknife, for fields of several lengths. */
#include "engine/experiment.h"
#include "engine/must.h"
#include "engine/sample.h"
#include "report/chart.h"
#include "report/run.h"

#include <math.h>
#include <stdlib.h>

enum { N_WAYS = 2, PER_FIELD = 6, BINS = 60, MAX_LENGTHS = 16 };

static const struct knob knobs[] = {
    {"lengths", "50,100,200,500,1000,2000", 20, 1e5, true,
     "galaxies in a field; each divides the last"},
    {"pictured", "500", 20, 1e5, false, "the length whose pulls are drawn"},
    {"jackknife", "50", 2, 1e5, false, "groups of the jackknife, where a field has so many blocks"},
    {0}};

static const char *const fixed[] = {"rotate", "groups", NULL};

static const char *const ways[N_WAYS] = {"delta", "jackknife"};

static void defaults(struct request *r) {
    shear_mock_spec *m = &r->mock;
    m->rotate = 1;
    m->nx = m->ny = 48;
    m->points = 100;
    m->white_sigma = 0.5;
    r->settings.filter = SHEAR_FILTER_NONE;
    r->settings.interpolation = SHEAR_INTERP_NONE;
    r->galaxies = 1000000;
}

/* ---- fields ---- */

static int chunk_length(const struct request *r) {
    const knob_values *lengths = request_list(r, "lengths");
    return (int)lengths->v[lengths->n - 1];
}

static int fields_of_chunk(const struct request *r, int length) {
    return chunk_length(r) / (int)request_list(r, "lengths")->v[length];
}

/* One field: g1, g2, errors of the delta method, errors of the jackknife. */
static int field_result(const shear_row *rows, int n, int groups, double out[PER_FIELD],
                        shear_error *err) {
    shear_field_sums *sums = NULL;
    shear_jackknife *jack = NULL;
    shear_result result;
    int blocks = (n + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
    int code = shear_field_sums_new(&sums, err);
    code = code != SHEAR_OK ? code
                            : shear_jackknife_new(&jack, groups < blocks ? groups : blocks, err);
    for (int from = 0; code == SHEAR_OK && from < n; from += SHEAR_BLOCK) {
        shear_block_sums block;
        shear_block_sums_init(&block);
        for (int i = from; i < n && i < from + SHEAR_BLOCK; i++) {
            shear_block_sums_add(&block, &rows[i]);
        }
        shear_field_sums_add(sums, &block);
        code = shear_jackknife_add(jack, &block, err);
    }
    if (code == SHEAR_OK) {
        shear_field_result(sums, &result);
        out[0] = result.g1;
        out[1] = result.g2;
        out[2] = result.g1_err;
        out[3] = result.g2_err;
        code = shear_jackknife_finish(jack, &result, err);
        out[4] = result.g1_err;
        out[5] = result.g2_err;
    }
    shear_jackknife_free(jack);
    shear_field_sums_free(sums);
    return code;
}

struct run {
    const struct request *request;
    struct sampler *sampler;
    shear_row *rows; /* [chunk_length] */
};

static int measure_chunk(void *context, int chunk, double *values, shear_error *err) {
    struct run *run = context;
    const struct request *r = run->request;
    int length = chunk_length(r);
    int groups = (int)request_number(r, "jackknife");
    int code = sampler_rows(run->sampler, (int64_t)chunk * length, length, run->rows, err);
    for (int k = 0; code == SHEAR_OK && k < request_list(r, "lengths")->n; k++) {
        int n = (int)request_list(r, "lengths")->v[k];
        for (int i = 0; code == SHEAR_OK && i < fields_of_chunk(r, k); i++) {
            code = field_result(run->rows + i * n, n, groups, values, err);
            values += PER_FIELD;
        }
    }
    return code;
}

static int values_of_chunk(const struct request *r) {
    int n = 0;
    for (int k = 0; k < request_list(r, "lengths")->n; k++) {
        n += fields_of_chunk(r, k);
    }
    return n * PER_FIELD;
}

static int measure(const struct request *r, struct ledger *ledger, int chunks, double *values,
                   shear_error *err) {
    struct run run = {.request = r};
    const struct scene scene = {.spec = r->mock};
    const struct series series = {.settings = r->settings};
    const sample_spec spec = {.name = "fields",
                              .stamps = (int64_t)chunks * chunk_length(r),
                              .threads = r->threads,
                              .n_scenes = 1,
                              .scenes = &scene,
                              .n_series = 1,
                              .series = &series};
    const struct task task = {.name = "fields",
                              .chunks = chunks,
                              .values = values_of_chunk(r),
                              .stamps_of_chunk = chunk_length(r),
                              .work = measure_chunk,
                              .context = &run};
    run.rows = calloc((size_t)chunk_length(r), sizeof *run.rows);
    int code = run.rows != NULL ? sampler_new(&run.sampler, &spec, err)
                                : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for rows");
    code = code != SHEAR_OK ? code : ledger_run(ledger, &task, values, err);
    sampler_free(run.sampler);
    free(run.rows);
    return code;
}

/* ---- pulls ---- */

/* Pulls of all fields of one length, both components. pulls [2 chunks fields_of_chunk]; returns how
 * many. */
static size_t collect(const struct request *r, const double *values, int chunks, int length,
                      int way, double *pulls) {
    size_t n = 0;
    size_t before = 0;
    for (int k = 0; k < length; k++) {
        before += (size_t)(fields_of_chunk(r, k) * PER_FIELD);
    }
    for (int chunk = 0; chunk < chunks; chunk++) {
        const double *v = values + (size_t)chunk * (size_t)values_of_chunk(r) + before;
        for (int i = 0; i < fields_of_chunk(r, length); i++, v += PER_FIELD) {
            pulls[n++] = (v[0] - r->mock.g1) / v[2 + 2 * way];
            pulls[n++] = (v[1] - r->mock.g2) / v[3 + 2 * way];
        }
    }
    return n;
}

struct outcome {
    struct curve width[N_WAYS];
    double counts[N_WAYS][BINS];
    double from[N_WAYS]; /* galaxies; NaN: none */
    size_t pictured;     /* pulls in the histogram */
};

static const shear_range drawn = {-4.5, 4.5};
static const double tolerance = 0.03;

static void add_columns(struct table *t) {
    table_column(t, "n", TABLE_INTEGER, 0, "", "galaxies in a field");
    table_column(t, "errors", TABLE_TEXT, 0, "", "delta method or jackknife");
    table_column(t, "groups", TABLE_INTEGER, 0, "", "of the jackknife");
    table_column(t, "pulls", TABLE_INTEGER, 0, "", "fields times two components");
    table_column(t, "mean", TABLE_NUMBER, 4, "", "of (measured - true) / quoted error");
    table_column(t, "mean_err", TABLE_NUMBER, 4, "", "its 1-sigma error");
    table_column(t, "width", TABLE_NUMBER, 4, "", "standard deviation of the pulls");
    table_column(t, "width_err", TABLE_NUMBER, 4, "", "its 1-sigma error");
    table_column(t, "ks", TABLE_NUMBER, 4, "", "Kolmogorov-Smirnov distance from a unit Gaussian");
    table_column(t, "p_gauss", TABLE_NUMBER, -3, "", "its probability");
    table_column(
        t, "p_student", TABLE_NUMBER, -3, "",
        "probability of the distance from Student's t with as many degrees of freedom as the "
        "error is known with (groups - 1)");
}

static void add_row(const struct request *r, struct table *t, int length, int way, double *pulls,
                    size_t n, struct outcome *o) {
    double p_gauss, p_student;
    int size = (int)request_list(r, "lengths")->v[length];
    int blocks = (size + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
    int groups = (int)fmin(request_number(r, "jackknife"), blocks);
    struct spread s = spread_of(pulls, n);
    if (size == (int)request_number(r, "pictured")) {
        shear_histogram(o->counts[way], BINS, drawn, pulls, n);
        o->pictured = n;
    }
    double ks = ks_distance(pulls, n, 0.0, &p_gauss);
    ks_distance(pulls, n, way != 0 ? groups - 1.0 : size - 1.0, &p_student);
    table_number(t, size);
    table_text(t, ways[way]);
    table_number(t, way != 0 ? (double)groups : NAN);
    table_number(t, (double)n);
    table_number(t, s.mean);
    table_number(t, s.mean_err);
    table_number(t, s.width);
    table_number(t, s.width_err);
    table_number(t, ks);
    table_number(t, p_gauss);
    table_number(t, p_student);
    curve_add(&o->width[way], size, s.width, s.width_err);
    if (fabs(s.width - 1.0) > tolerance + s.width_err) {
        o->from[way] = NAN;
    } else if (isnan(o->from[way])) {
        o->from[way] = size;
    }
}

static int add_rows(const struct request *r, const double *values, int chunks, struct table *t,
                    struct outcome *o, shear_error *err) {
    size_t most = 2 * (size_t)chunks * (size_t)fields_of_chunk(r, 0);
    int code = SHEAR_OK;
    double *pulls = memory_new(most, sizeof *pulls, "pulls", &code, err);
    if (code != SHEAR_OK) {
        return code;
    }
    o->from[0] = o->from[1] = NAN;
    for (int k = 0; k < request_list(r, "lengths")->n; k++) {
        for (int way = 0; way < N_WAYS; way++) {
            size_t n = collect(r, values, chunks, k, way, pulls);
            add_row(r, t, k, way, pulls, n, o);
        }
    }
    free(pulls);
    for (int way = 0; way < N_WAYS; way++) {
        if (isnan(o->from[way])) {
            table_meta(t, "verdict", "%s: no length has a width within %.0f %% of 1", ways[way],
                       100.0 * tolerance);
        } else {
            table_meta(t, "verdict",
                       "%s: the pulls' width is within %.0f %% (and its own error) of 1 from %.0f "
                       "galaxies on",
                       ways[way], 100.0 * tolerance, o->from[way]);
        }
    }
    return SHEAR_OK;
}

/* ---- figure ---- */

static void draw_pulls(const struct request *r, shear_figure *f, shear_rect cell,
                       const struct outcome *o) {
    double x[BINS], y[BINS];
    char title[48];
    double width = (drawn.hi - drawn.lo) / BINS;
    double top = 1.0;
    for (int i = 0; i < BINS; i++) {
        x[i] = drawn.lo + (i + 0.5) * width;
        y[i] = (double)o->pictured * width * exp(-0.5 * x[i] * x[i]) / sqrt(2.0 * M_PI);
        top = fmax(top, fmax(y[i], fmax(o->counts[0][i], o->counts[1][i])));
    }
    snprintf(title, sizeof title, "fields of %.0f galaxies", request_number(r, "pictured"));
    shear_axes_begin(f, &(shear_axes){.cell = cell,
                                      .title = title,
                                      .x = {.range = drawn, .label = "(measured - true) / error"},
                                      .y = {.range = {0.0, 1.3 * top}, .label = "pulls"}});
    shear_axes_histogram(
        f, BINS, drawn, o->counts[0],
        &(shear_style){.colour = shear_palette(SHEAR_BLUE), .fill = 0.2, .label = "delta method"});
    shear_axes_histogram(
        f, BINS, drawn, o->counts[1],
        &(shear_style){.colour = shear_palette(SHEAR_VERMILION), .label = "jackknife"});
    shear_axes_line(f, BINS, x, y, &(shear_style){.dash = SHEAR_DASHED, .label = "unit Gaussian"});
    shear_axes_end(f);
}

static int draw(const struct request *r, struct outcome *o, shear_figure **f, shear_error *err) {
    int code = shear_figure_new(f, 940, 400, err);
    const shear_grid grid = {.area = {8, 8, 924, 384}, .rows = 1, .columns = 2, .gap_x = 12};
    if (code == SHEAR_OK) {
        draw_pulls(r, *f, shear_grid_cell(&grid, 0, 0, 1, 1), o);
        for (int way = 0; way < N_WAYS; way++) {
            o->width[way].hue = way != 0 ? SHEAR_VERMILION : SHEAR_BLUE;
            o->width[way].marker = way != 0 ? SHEAR_SQUARE : SHEAR_DISC;
            o->width[way].label = way != 0 ? "jackknife" : "delta method";
        }
        chart_draw(*f, &(struct chart){.cell = shear_grid_cell(&grid, 0, 1, 1, 1),
                                       .title = "width of the pulls",
                                       .x_label = "galaxies in a field",
                                       .y_label = "standard deviation",
                                       .log_x = true,
                                       .truth = 1.0,
                                       .spread = 0.012,
                                       .n_curves = N_WAYS,
                                       .curves = o->width});
    }
    return code;
}

/* ---- all ---- */

static int check(const struct request *r, shear_error *err) {
    const knob_values *lengths = request_list(r, "lengths");
    for (int k = 0; k < lengths->n; k++) {
        if (fmod(lengths->v[lengths->n - 1], lengths->v[k]) != 0.0 ||
            lengths->v[k] != floor(lengths->v[k])) {
            return shear_fail(err, SHEAR_E_SETTING, NULL,
                              "option '--lengths': %g does not divide the last, %g", lengths->v[k],
                              lengths->v[lengths->n - 1]);
        }
    }
    if (r->galaxies < 4 * chunk_length(r)) {
        return shear_fail(err, SHEAR_E_SETTING, NULL,
                          "option '--galaxies': at least %d for these lengths",
                          4 * chunk_length(r));
    }
    return SHEAR_OK;
}

static int finish(const struct request *r, const struct ledger *ledger, const double *values,
                  int chunks, shear_error *err) {
    struct table *t = table_new(r);
    shear_figure *f = NULL;
    int code = SHEAR_OK;
    struct outcome *o = memory_new(1, sizeof *o, "results", &code, err);
    add_columns(t);
    code = code != SHEAR_OK ? code : add_rows(r, values, chunks, t, o, err);
    code = code != SHEAR_OK ? code : draw(r, o, &f, err);
    code = code != SHEAR_OK ? code : report_save(r, ledger, t, f, err);
    shear_figure_free(f);
    free(o);
    table_free(t);
    return code;
}

static int exec(const struct request *r, shear_error *err) {
    struct ledger *ledger = NULL;
    int code = check(r, err);
    int chunks = (int)(r->galaxies / chunk_length(r));
    size_t size = (size_t)chunks * (size_t)values_of_chunk(r);
    double *values = memory_new(size, sizeof *values, "fields", &code, err);
    code =
        code != SHEAR_OK ? code : ledger_open(&ledger, r, (int64_t)chunks * chunk_length(r), err);
    code = code != SHEAR_OK ? code : measure(r, ledger, chunks, values, err);
    code = code != SHEAR_OK ? code : finish(r, ledger, values, chunks, err);
    free(values);
    ledger_close(ledger);
    return code;
}

const experiment exp_errors = {
    .name = "errors",
    .summary = "beyond the paper: are the quoted errors honest?",
    .about = "Fields of unpaired regular galaxies in white noise: 2000 of 500 galaxies, and the "
             "same galaxies\n"
             "cut into shorter and longer fields. The pulls, (measured - true) / quoted error, of "
             "the delta\n"
             "method and of the jackknife: mean, width, Kolmogorov-Smirnov.",
    .knobs = knobs,
    .fixed = fixed,
    .defaults = defaults,
    .exec = exec,
};
