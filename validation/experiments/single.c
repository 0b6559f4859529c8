/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Section 4.3, second figure: the shear of one galaxy, placed at random positions on the grid. */
#include "experiments/single.h"
#include "engine/experiment.h"
#include "engine/methods.h"
#include "engine/must.h"

#include <stdlib.h>

enum { CHUNK = 50 }; /* positions between two checkpoints */

static const struct knob knobs[] = {
    {"ratios", "2,1.5,1,0.5", 0.05, 4, true, "pixel size over R_PSF, at most four"},
    {"objects", "8", 1, MAX_OBJECTS, false, "galaxies; the figure shows the first"},
    {"size", "5", 0.5, 50, false, "R_G over R_PSF"},
    {"step", "0.375", 0.001, 50, false, "step of the random walk over R_PSF"},
    {"beta", "1.33333333333333333", 0.5, 10, false, "beta over R_PSF"},
    {0}};

static const char *const fixed[] = {
    "size",   "r-gal", "r-psf",      "step-size",     "offset",   "no-shift", "rotate",
    "groups", "beta",  "beta-ratio", "interpolation", "oversamp", NULL};

static void defaults(struct request *r) {
    r->mock.g1 = r->mock.g2 = 0.0;
    r->mock.rotate = 1;
    r->mock.galaxy = SHEAR_MOCK_IRREGULAR;
    r->mock.psf = SHEAR_MOCK_PSF_B;
    r->galaxies = 1000;
    r->settings.filter = SHEAR_FILTER_NONE;
    r->settings.zeros = SHEAR_ZEROS_FLOOR;
}

/* ---- one ratio ---- */

/* A galaxy at a pixel size of `ratio` R_PSF. */
static shear_mock_spec spec_at(const struct request *r, int object, double ratio) {
    shear_mock_spec m = r->mock;
    m.seed += (uint64_t)object;
    m.r_psf_px = 1.0 / ratio;
    m.r_gal_px = request_number(r, "size") * m.r_psf_px;
    m.step_px = request_number(r, "step") * m.r_psf_px;
    m.nx = m.ny = stamp_side(m.r_gal_px, m.r_psf_px);
    return m;
}

/* The positions are those that the mocks draw for the centres of so many galaxies. */
static void place(const void *context, int64_t stamp, shear_mock_spec *spec) {
    shear_mock_centre(context, stamp, &spec->offset_x, &spec->offset_y);
    spec->shift = false;
}

struct run {
    struct sampler *sampler;
    int64_t n;
    shear_row rows[N_SERIES * CHUNK];
};

/* values [N_SERIES][CHUNK][2] */
static int measure_chunk(void *context, int chunk, double *values, shear_error *err) {
    struct run *run = context;
    int64_t first = (int64_t)chunk * CHUNK;
    int count = run->n - first < CHUNK ? (int)(run->n - first) : CHUNK;
    int code = sampler_rows(run->sampler, first, count, run->rows, err);
    for (int i = 0; code == SHEAR_OK && i < N_SERIES; i++) {
        for (int k = 0; k < count; k++) {
            const shear_row *row = &run->rows[i * count + k];
            values[2 * (i * CHUNK + k)] = row->n1 / row->d;
            values[2 * (i * CHUNK + k) + 1] = row->n2 / row->d;
        }
    }
    return code;
}

static int shears_new(struct shears *s, int64_t n, shear_error *err) {
    s->n = n;
    s->g[0] = calloc((size_t)n * N_SERIES, sizeof *s->g[0]);
    s->g[1] = calloc((size_t)n * N_SERIES, sizeof *s->g[1]);
    return s->g[0] != NULL && s->g[1] != NULL
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
}

static void shears_free(struct shears *s) {
    free(s->g[0]);
    free(s->g[1]);
}

static void unpack(const double *values, struct shears *s) {
    for (int64_t k = 0; k < s->n; k++) {
        for (int i = 0; i < N_SERIES; i++) {
            const double *v =
                values + k / CHUNK * (2 * N_SERIES * CHUNK) + 2 * (i * CHUNK + k % CHUNK);
            s->g[0][i * s->n + k] = v[0];
            s->g[1][i * s->n + k] = v[1];
        }
    }
}

static int run_task(const struct request *r, struct ledger *ledger, struct run *run,
                    const char *name, struct shears *out, shear_error *err) {
    int chunks = (int)((r->galaxies + CHUNK - 1) / CHUNK);
    const struct task task = {.name = name,
                              .chunks = chunks,
                              .values = 2 * N_SERIES * CHUNK,
                              .stamps_of_chunk = CHUNK,
                              .work = measure_chunk,
                              .context = run};
    int code = shears_new(out, r->galaxies, err);
    size_t size = (size_t)chunks * (size_t)task.values;
    double *values = memory_new(size, sizeof *values, "shears", &code, err);
    code = code != SHEAR_OK ? code : ledger_run(ledger, &task, values, err);
    if (code == SHEAR_OK) {
        unpack(values, out);
    }
    free(values);
    return code;
}

static int measure(const struct request *r, struct ledger *ledger, int object, double ratio,
                   struct shears *out, shear_error *err) {
    shear_mock *positions = NULL;
    char name[40];
    struct series series[N_SERIES];
    const struct scene scene = {.spec = spec_at(r, object, ratio)};
    shear_settings settings = r->settings;
    settings.beta_px = request_number(r, "beta") / ratio;
    for (int i = 0; i < N_SERIES; i++) {
        series[i] = method_series(0, i % N_METHODS, (enum psf_sampling)(i / N_METHODS), 1.0 / ratio,
                                  &settings);
    }
    shear_mock_spec draws = scene.spec;
    draws.n_stamps = r->galaxies;
    sample_spec spec = {.name = "single",
                        .stamps = r->galaxies,
                        .threads = r->threads,
                        .n_scenes = 1,
                        .scenes = &scene,
                        .n_series = N_SERIES,
                        .series = series,
                        .vary = place};
    struct run *run = calloc(1, sizeof *run);
    int code = run != NULL ? shear_mock_new(&positions, &draws, err)
                           : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for rows");
    if (code == SHEAR_OK) {
        spec.context = positions;
        run->n = r->galaxies;
        code = sampler_new(&run->sampler, &spec, err);
    }
    snprintf(name, sizeof name, "%d:pixel/R_PSF=%g", object, ratio);
    code = code != SHEAR_OK ? code : run_task(r, ledger, run, name, out, err);
    sampler_free(run != NULL ? run->sampler : NULL);
    shear_mock_free(positions);
    free(run);
    return code;
}

/* The galaxy's shear where pixels do not matter: R_PSF = 8 pixels, not interpolated. */
static int measure_truth(const struct request *r, int object, double truth[2], shear_error *err) {
    static const double fine = 0.125;
    struct sampler *s = NULL;
    shear_row row = {0};
    const struct scene scene = {.spec = spec_at(r, object, fine)};
    struct series series = {.settings = r->settings};
    series.settings.interpolation = SHEAR_INTERP_NONE;
    series.settings.oversample = 0;
    series.settings.beta_px = request_number(r, "beta") / fine;
    const sample_spec spec = {.name = "truth",
                              .stamps = 1,
                              .threads = 1,
                              .n_scenes = 1,
                              .scenes = &scene,
                              .n_series = 1,
                              .series = &series};
    int code = sampler_new(&s, &spec, err);
    code = code != SHEAR_OK ? code : sampler_rows(s, 0, 1, &row, err);
    truth[0] = row.n1 / row.d;
    truth[1] = row.n2 / row.d;
    sampler_free(s);
    return code;
}

static int measure_all(const struct request *r, struct ledger *ledger, struct object *objects,
                       shear_error *err) {
    const knob_values *ratios = request_list(r, "ratios");
    int code = SHEAR_OK;
    for (int i = 0; code == SHEAR_OK && i < (int)request_number(r, "objects"); i++) {
        code = measure_truth(r, i, objects[i].truth, err);
        for (int k = 0; code == SHEAR_OK && k < ratios->n; k++) {
            code = measure(r, ledger, i, ratios->v[k], &objects[i].at[k], err);
        }
    }
    return code;
}

static int exec(const struct request *r, shear_error *err) {
    int n = (int)request_number(r, "objects");
    int ratios = request_list(r, "ratios")->n;
    struct ledger *ledger = NULL;
    int code = SHEAR_OK;
    struct object *objects = memory_new((size_t)n, sizeof *objects, "galaxies", &code, err);
    if (code == SHEAR_OK && ratios > MAX_RATIOS) {
        code = shear_fail(err, SHEAR_E_SETTING, NULL, "option '--ratios': at most %d", MAX_RATIOS);
    }
    code = code != SHEAR_OK ? code : ledger_open(&ledger, r, r->galaxies * n * ratios, err);
    code = code != SHEAR_OK ? code : measure_all(r, ledger, objects, err);
    code = code != SHEAR_OK ? code : single_report(r, ledger, objects, err);
    for (int i = 0; objects != NULL && i < n * MAX_RATIOS; i++) {
        shears_free(&objects[i / MAX_RATIOS].at[i % MAX_RATIOS]);
    }
    free(objects);
    ledger_close(ledger);
    return code;
}

const experiment exp_single = {
    .name = "single",
    .summary = "section 4.3: the shear of one galaxy at random positions on the grid",
    .about = "One irregular galaxy of R_G = 5 R_PSF at --galaxies random positions, for pixels of "
             "2, 1.5, 1\n"
             "and 0.5 R_PSF, without noise. The PSF is given finely sampled, and again as coarse "
             "as the\n"
             "pixels, so that it is interpolated too (single-coarse.png). The truth is the same "
             "galaxy's\n"
             "shear at R_PSF = 8 pixels.",
    .knobs = knobs,
    .fixed = fixed,
    .defaults = defaults,
    .exec = exec,
};
