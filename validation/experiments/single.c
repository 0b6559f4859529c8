/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Experiment `single` (section 4.3, second figure): the shear of one galaxy at random positions on
 * the grid. */
#include "engine/methods.h"
#include "engine/must.h"
#include "experiments/list.h"
#include "report/run.h"

#include <math.h>
#include <stdlib.h>

enum { MAX_RATIOS = 4, MAX_OBJECTS = 64, BINS = 60 };
enum { CHUNK = 50 }; /* positions per chunk of the result cache */

static const parameter parameters[] = {
    {"ratios", "2,1.5,1,0.5", 0.05, 4, MAX_RATIOS, "pixel size over R_PSF, at most four"},
    {"objects", "8", 1, MAX_OBJECTS, 1, "galaxies; the figure shows the first"},
    {"size", "5", 0.5, 50, 1, "R_G over R_PSF"},
    {"step", "0.375", 0.001, 50, 1, "step of the random walk over R_PSF"},
    {"beta", "1.33333333333333333", 0.5, 10, 1, "beta over R_PSF"},
    {0}};

static int64_t stamps(const options *o) {
    return o->galaxies * (int)options_number(o, "objects") * options_list(o, "ratios")->n;
}

/* ---- measuring ---- */

/* Shears of every series (method + N_METHODS * psf_sampling) at every position. */
typedef struct shears {
    int64_t n;
    double *g[2]; /* g1 and g2: [N_METHOD_SERIES][n], owned */
} shears;

typedef struct object {
    double truth[2]; /* its shear without the effect of pixels */
    shears at[MAX_RATIOS];
} object;

typedef struct objects {
    const parameter_values *ratios;
    int n;
    object of[MAX_OBJECTS];
} objects;

/* Return the spec of a galaxy with R_PSF = `ratio` pixels. */
static shear_mock_spec spec_at(const options *o, int i_object, double ratio) {
    shear_mock_spec m = o->mock;
    m.seed += (uint64_t)i_object;
    m.r_psf_px = 1.0 / ratio;
    m.r_gal_px = options_number(o, "size") * m.r_psf_px;
    m.step_px = options_number(o, "step") * m.r_psf_px;
    m.nx = m.ny = stamp_side(m.r_gal_px, m.r_psf_px);
    return m;
}

/* Set the position: the one that the mocks draw for the centre of galaxy number `stamp`. */
static void place(const void *context, int64_t stamp, shear_mock_spec *spec) {
    shear_mock_centre(context, stamp, &spec->offset_x, &spec->offset_y);
    spec->shift = false;
}

typedef struct positions {
    sampler *sampler;
    int64_t n;
} positions;

/* Measure a chunk: values [N_METHOD_SERIES][CHUNK][2]. */
static void measure_chunk(void *context, int chunk, double *values) {
    const positions *p = context;
    const int64_t first = (int64_t)chunk * CHUNK;
    const int count = p->n - first < CHUNK ? (int)(p->n - first) : CHUNK;
    static shear_row rows[N_METHOD_SERIES * CHUNK];
    sampler_rows(p->sampler, first, count, rows);
    for (int i = 0; i < N_METHOD_SERIES * count; i++) {
        const int at = i / count * CHUNK + i % count;
        values[2 * at] = rows[i].n1 / rows[i].d;
        values[2 * at + 1] = rows[i].n2 / rows[i].d;
    }
}

static shears unpack(const double *values, int64_t n) {
    shears s = {.n = n};
    for (int c = 0; c < 2; c++) {
        s.g[c] = must_allocate((size_t)n * N_METHOD_SERIES, sizeof *s.g[c], "shears");
        for (int64_t i = 0; i < n * N_METHOD_SERIES; i++) {
            const int64_t k = i % n;
            const int64_t at = (k / CHUNK * N_METHOD_SERIES + i / n) * CHUNK + k % CHUNK;
            s.g[c][i] = values[2 * at + c];
        }
    }
    return s;
}

static shears measure(const options *o, cache *c, int i_object, double ratio) {
    sample what = {.n_scenes = 1,
                   .scenes = {{.spec = spec_at(o, i_object, ratio)}},
                   .n_series = N_METHOD_SERIES,
                   .vary = place};
    shear_settings settings = o->settings;
    CLEANUP(shear_mock_release)
    shear_mock *centres = sampler_mock(&what.scenes[0].spec, o->galaxies);
    settings.beta_px = options_number(o, "beta") / ratio;
    what.context = centres;
    method_series_all(what.series, 1.0 / ratio, &settings);
    snprintf(what.name, sizeof what.name, "%d:pixel/R_PSF=%g", i_object, ratio);
    positions p = {sampler_new(&what, o->galaxies, o->threads), o->galaxies};
    CLEANUP(release_free)
    double *values =
        cache_run(c, &(cache_task){what.name, .chunks = (int)((o->galaxies + CHUNK - 1) / CHUNK),
                                   .values = 2 * N_METHOD_SERIES * CHUNK, .stamps_of_chunk = CHUNK,
                                   .work = measure_chunk, .context = &p});
    const shears s = unpack(values, o->galaxies);
    sampler_free(p.sampler);
    return s;
}

/* Measure the galaxy's shear without the effect of pixels: R_PSF = 8 pixels, not interpolated. */
static void measure_truth(const options *o, int i_object, double truth[2]) {
    static const double fine = 0.125;
    shear_row row = {0};
    sample only = {"truth", .n_scenes = 1, .scenes = {{.spec = spec_at(o, i_object, fine)}},
                   .n_series = 1, .series = {{.settings = o->settings}}};
    only.series[0].settings.interpolation = SHEAR_INTERP_NONE;
    only.series[0].settings.oversample = 0;
    only.series[0].settings.beta_px = options_number(o, "beta") / fine;
    CLEANUP(sampler_release) sampler *s = sampler_new(&only, 1, 1);
    sampler_rows(s, 0, 1, &row);
    truth[0] = row.n1 / row.d;
    truth[1] = row.n2 / row.d;
}

/* ---- table ---- */

/* Return the squared distance from the truth at one position. */
static double square_of(const object *o, int ratio, int i_series, int64_t k) {
    const shears *s = &o->at[ratio];
    const double d1 = s->g[0][i_series * s->n + k] - o->truth[0];
    const double d2 = s->g[1][i_series * s->n + k] - o->truth[1];
    return d1 * d1 + d2 * d2;
}

/* Return the root mean square distance of a component from the truth. */
static double rms_of(const object *o, int ratio, int i_series) {
    double sum = 0.0;
    for (int64_t k = 0; k < o->at[ratio].n; k++)
        sum += square_of(o, ratio, i_series, k);
    return sqrt(sum / (2.0 * (double)o->at[ratio].n));
}

static double rms_of_all(const objects *all, int ratio, int i_series) {
    double sum = 0.0;
    for (int i = 0; i < all->n; i++) {
        const double rms = rms_of(&all->of[i], ratio, i_series);
        sum += rms * rms / all->n;
    }
    return sqrt(sum);
}

/* Return +1 if series `a` is closer to the truth than `b` by 3 errors of their difference at the
 * same positions, -1 if it is farther, 0 otherwise. */
static int nearer(const object *o, int ratio, int a, int b) {
    const double n = (double)o->at[ratio].n;
    double sum = 0.0;
    double square = 0.0;
    for (int64_t k = 0; k < o->at[ratio].n; k++) {
        const double d = square_of(o, ratio, b, k) - square_of(o, ratio, a, k);
        sum += d;
        square += d * d;
    }
    const double err = sqrt(fmax(square - sum * sum / n, 0.0));
    return sum > 3.0 * err ? 1 : sum < -3.0 * err ? -1 : 0;
}

/* Return the series of the same PSF without the logarithm; -1 if i has no logarithm. */
static int plain_of(int i_series) {
    const int plain = methods[i_series % N_METHODS].plain;
    return plain >= 0 ? i_series / N_METHODS * N_METHODS + plain : -1;
}

/* Numbers of objects for which a series is closer, and farther, than the one without the logarithm.
 */
typedef struct counts {
    int near, far;
} counts;

static counts count(const objects *all, int ratio, int i_series) {
    counts c = {0};
    for (int i = 0; i < all->n; i++) {
        const int sign = nearer(&all->of[i], ratio, i_series, plain_of(i_series));
        c.near += sign > 0;
        c.far += sign < 0;
    }
    return c;
}

static const column columns[] = {
    {"ratio", TABLE_NUMBER, 2, .help = "pixel size over R_PSF"},
    {"method", TABLE_TEXT, 0, .help = "interpolation"},
    {"psf", TABLE_TEXT, 0,
     .help = "PSF given finely sampled, or interpolated from the same pixels"},
    {"bias#", TABLE_NUMBER, 5, .help = "mean over positions, minus the well-sampled shear",
     .with_error = true},
    {"pull#", TABLE_NUMBER, 1, .help = "bias / error"},
    {"scatter#", TABLE_NUMBER, 5, .help = "standard deviation over positions"},
    {"rms", TABLE_NUMBER, 5, .help = "root mean square deviation of a component"},
    {"rms_all", TABLE_NUMBER, 5, .help = "the same over all objects"},
    {"nearer", TABLE_INTEGER, 0,
     .help = "objects for which it is nearer to the truth than without the logarithm"},
    {"farther", TABLE_INTEGER, 0, .help = "objects for which it is farther from it"},
    {0}};

static void add_row(table *t, const objects *all, int k, int i_series) {
    const object *first = &all->of[0];
    const shears *s = &first->at[k];
    table_numbers(t, all->ratios->v[k]);
    table_texts(t, methods[i_series % N_METHODS].label, psf_sampling_names[i_series / N_METHODS]);
    for (int c = 0; c < 2; c++) {
        const spread over = spread_of(s->g[c] + i_series * s->n, (size_t)s->n);
        const double bias = over.mean - first->truth[c];
        table_numbers(t, bias, over.mean_err, bias / over.mean_err, over.width);
    }
    table_numbers(t, rms_of(first, k, i_series), rms_of_all(all, k, i_series));
    if (plain_of(i_series) >= 0) {
        const counts c = count(all, k, i_series);
        table_numbers(t, c.near, c.far);
        return;
    }
    table_numbers(t, NAN, NAN);
}

/* Add a conclusion: in how many cases, over all objects, the logarithm has the smaller root mean
 * square. */
static void conclude(table *t, const objects *all, int psf) {
    const int ratios = all->ratios->n;
    int better = 0;
    for (int i = psf * N_METHODS; i < (psf + 1) * N_METHODS; i++) {
        for (int k = 0; k < ratios && plain_of(i) >= 0; k++)
            better += rms_of_all(all, k, i) < rms_of_all(all, k, plain_of(i));
    }
    table_meta(t, TABLE_CONCLUSION,
               "%s PSF: over %d galaxies the logarithm is nearer to the truth in %d of %d cases",
               psf_sampling_names[psf], all->n, better, ratios * N_METHODS / 2);
}

static void add_count(table *t, const objects *all, int i_series) {
    counts sum = {0};
    for (int k = 0; k < all->ratios->n; k++) {
        const counts c = count(all, k, i_series);
        sum.near += c.near;
        sum.far += c.far;
    }
    table_meta(
        t, "count", "%s PSF: %s is nearer to the truth than %s in %d of %d cases, farther in %d",
        psf_sampling_names[i_series / N_METHODS], methods[i_series % N_METHODS].label,
        methods[plain_of(i_series) % N_METHODS].label, sum.near, all->n * all->ratios->n, sum.far);
}

static void tabulate(table *t, const objects *all) {
    table_columns(t, columns);
    table_meta(t, "well_sampled", "%.6f, %.6f", all->of[0].truth[0], all->of[0].truth[1]);
    for (int i = 0; i < all->ratios->n * N_METHOD_SERIES; i++)
        add_row(t, all, i / N_METHOD_SERIES, i % N_METHOD_SERIES);
    for (int i = 0; i < N_METHOD_SERIES; i++) {
        if (plain_of(i) >= 0)
            add_count(t, all, i);
    }
    for (int psf = 0; psf < N_PSF_SAMPLINGS; psf++)
        conclude(t, all, psf);
}

/* ---- figures of the first object ---- */

/* Return a range that contains the widest histogram of the log methods; values beyond it are cut
 * off. */
static shear_range choose_range(const object *first, int n_ratios, int c) {
    const double truth = first->truth[c];
    double reach = 1e-4;
    for (int i = 0; i < n_ratios * N_METHODS; i++) {
        const shears *s = &first->at[i / N_METHODS];
        const double *g = s->g[c] + i % N_METHODS * s->n;
        shear_range part;
        if (plain_of(i % N_METHODS) >= 0) {
            must(shear_range_percentile(&part, g, (size_t)s->n, 5, 95, &must_error));
            reach = fmax(reach, fmax(truth - part.lo, part.hi - truth));
        }
    }
    return (shear_range){truth - 1.5 * reach, truth + 1.5 * reach};
}

static void draw_histogram(shear_figure *f, shear_range range, const double *g, int64_t n,
                           const shear_style *style) {
    double bins[BINS];
    shear_histogram(bins, BINS, range, g, (size_t)n);
    const double top = fmax(shear_range_of(bins, BINS).hi, 1.0);
    for (int b = 0; b < BINS; b++)
        bins[b] /= top;
    shear_axes_histogram(f, BINS, range, bins, style);
}

static void draw_panel(shear_figure *f, shear_rect cell, const objects *all, int i_series, int c,
                       shear_range range) {
    /* The paper's colours: purple, blue, red, black. */
    static const int hues[MAX_RATIOS] = {SHEAR_PURPLE, SHEAR_BLUE, SHEAR_VERMILION, SHEAR_BLACK};
    const object *first = &all->of[0];
    shear_axes_begin(f, &(shear_axes){cell, methods[i_series % N_METHODS].label,
                                      .x = {.range = range, .label = c != 0 ? "g_{2}" : "g_{1}"},
                                      .y = {.range = {0.0, 1.12}}, .legend = SHEAR_TOP_LEFT});
    shear_axes_vline(f, first->truth[c], &(shear_style){.dash = SHEAR_DOTTED, .width = 1.2});
    for (int k = 0; k < all->ratios->n; k++) {
        const shears *s = &first->at[k];
        char label[32];
        snprintf(label, sizeof label, "%g", all->ratios->v[k]);
        draw_histogram(f, range, s->g[c] + i_series * s->n, s->n,
                       &(shear_style){shear_palette(hues[k]), .width = 1.3,
                                      .label = i_series % N_METHODS != 0 ? NULL : label});
    }
    shear_axes_end(f);
}

static void draw(run *r, const char *suffix, const objects *all, int psf, int c) {
    const shear_range range = choose_range(&all->of[0], all->ratios->n, c);
    const panels p = run_panels(r, suffix, 900, 560,
                                (shear_grid){.rows = 2, .columns = 3, .gap_x = 8, .gap_y = 6});
    for (int i = 0; i < N_METHODS; i++)
        draw_panel(p.figure, panels_cell(&p, i), all, psf * N_METHODS + i, c, range);
}

static void run_single(run *r) {
    const options *o = r->options;
    static objects all;
    all.ratios = options_list(o, "ratios");
    all.n = (int)options_number(o, "objects");
    for (int i = 0; i < all.n; i++) {
        measure_truth(o, i, all.of[i].truth);
        for (int k = 0; k < all.ratios->n; k++)
            all.of[i].at[k] = measure(o, r->cache, i, all.ratios->v[k]);
    }
    tabulate(r->table, &all);
    draw(r, NULL, &all, PSF_FINE, 0);
    draw(r, "g2", &all, PSF_FINE, 1);
    draw(r, "coarse", &all, PSF_COARSE, 0);
    for (int i = 0; i < all.n * MAX_RATIOS; i++) {
        free(all.of[i / MAX_RATIOS].at[i % MAX_RATIOS].g[0]);
        free(all.of[i / MAX_RATIOS].at[i % MAX_RATIOS].g[1]);
    }
}

const experiment experiment_single = {
    "single",
    "section 4.3: the shear of one galaxy at random positions on the grid",
    "One irregular galaxy of R_G = 5 R_PSF at --galaxies random positions, for pixels of 2,\n"
    "1.5, 1 and 0.5 R_PSF, without noise. The PSF is given finely sampled, and again as\n"
    "coarse as the pixels, so that it is interpolated too (single-coarse.png). The truth is\n"
    "the same galaxy's shear at R_PSF = 8 pixels.",
    .defaults = "shear=0,0 rotate=1 galaxy=irregular psf=b galaxies=1000 filter=none zeros=floor",
    .fixed = "size r-gal r-psf step-size offset no-shift rotate groups beta beta-ratio "
             "interpolation oversamp",
    .parameters = parameters,
    .stamps = stamps,
    .run = run_single};
