/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/sample.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* Stamps that a thread draws at a time: a multiple of 4, so that rotated copies stay together. */
enum { TILE = 8 };

/* One thread's images and workspaces. */
struct bench {
    double *galaxy, *noise;           /* [TILE][ny][nx] of the scene at hand */
    double *shared, *shared_n, *bare; /* the same: shared noise of both stamps; scratch */
    shear_workspace **workspaces;     /* [n_plans] */
};

struct sampler {
    sample_spec spec;
    shear_mock **mocks;                 /* [n_scenes] */
    shear_mock *noise_mock, *bare_mock; /* the shared noise's, with and without it */
    int n_plans;
    shear_plan **plans; /* [n_plans <= n_series] */
    int *plan_of;       /* [n_series] */
    size_t pixels;      /* of a stamp, of the largest scene */
    int n_benches;
    struct bench *benches;
};

static int no_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, "use fewer threads",
                      "out of memory for a sample of stamps");
}

/* ---- plans ---- */

static void resolve_settings(shear_settings *s, const shear_mock_spec *m) {
    if (isnan(s->beta_px)) {
        s->beta_px = fmax(s->beta_ratio * m->r_psf_px, s->beta_floor_px);
    }
    bool paper = s->filter == SHEAR_FILTER_PAPER || s->filter == SHEAR_FILTER_AUTO ||
                 s->filter == SHEAR_FILTER_R_GAL;
    if (paper && isnan(s->core_px)) {
        s->filter = SHEAR_FILTER_AUTO; /* which is what a core of one's own goes with */
        s->core_px = m->r_gal_px + 4.0 * s->beta_px;
        s->width_px = isnan(s->width_px) ? s->beta_px : s->width_px;
    }
}

/* A mock whose PSF image is sampled as the series wants it. */
static shear_mock_spec spec_of_series(const struct sampler *s, int series) {
    shear_mock_spec m = s->spec.scenes[s->spec.series[series].scene].spec;
    int oversample = s->spec.series[series].psf_oversample;
    m.n_stamps = s->spec.stamps;
    m.oversample = oversample > 0 ? oversample : m.oversample;
    return m;
}

/* Members that a plan depends on. */
static bool same_plan(const struct sampler *s, int a, int b) {
    shear_mock_spec ma = spec_of_series(s, a);
    shear_mock_spec mb = spec_of_series(s, b);
    shear_settings sa = s->spec.series[a].settings;
    shear_settings sb = s->spec.series[b].settings;
    resolve_settings(&sa, &ma);
    resolve_settings(&sb, &mb);
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    bool same = ma.nx == mb.nx && ma.ny == mb.ny && ma.psf == mb.psf &&
                ma.r_psf_px == mb.r_psf_px && ma.psf_angle_deg == mb.psf_angle_deg &&
                ma.oversample == mb.oversample && ma.psf_size == mb.psf_size;
    for (size_t i = 0; same && i < n; i++) {
        char ta[64];
        char tb[64];
        same = strcmp(shear_settings_format(&sa, &table[i], ta, sizeof ta),
                      shear_settings_format(&sb, &table[i], tb, sizeof tb)) == 0;
    }
    return same;
}

static int make_plan(struct sampler *s, int series, shear_plan **plan, shear_error *err) {
    shear_mock_spec m = spec_of_series(s, series);
    shear_settings settings = s->spec.series[series].settings;
    shear_mock *mock = NULL;
    double *psf = NULL;
    resolve_settings(&settings, &m);
    int code = shear_mock_new(&mock, &m, err);
    if (code != SHEAR_OK) {
        return code;
    }
    const shear_geometry *g = &shear_mock_get_info(mock)->geometry;
    psf = calloc((size_t)g->psf_nx * (size_t)g->psf_ny, sizeof *psf);
    if (psf == NULL) {
        code = no_memory(err);
        goto done;
    }
    shear_mock_psf_image(mock, 0, psf);
    code = shear_plan_new(
        plan, &(shear_plan_request){.settings = &settings, .geometry = *g, .psf = psf}, err);
done:
    free(psf);
    shear_mock_free(mock);
    return code;
}

/* The series before this one that has the same plan, or the series itself. */
static int like(const struct sampler *s, int series) {
    for (int i = 0; i < series; i++) {
        if (same_plan(s, i, series)) {
            return i;
        }
    }
    return series;
}

static int make_plans(struct sampler *s, shear_error *err) {
    for (int i = 0; i < s->spec.n_series; i++) {
        int twin = like(s, i);
        if (twin < i) {
            s->plan_of[i] = s->plan_of[twin];
            continue;
        }
        int code = make_plan(s, i, &s->plans[s->n_plans], err);
        if (code != SHEAR_OK) {
            return shear_prefix(err, code, "%s, series %d", s->spec.name, i);
        }
        s->plan_of[i] = s->n_plans++;
    }
    return SHEAR_OK;
}

/* ---- mocks ---- */

static int make_mock(struct sampler *s, const shear_mock_spec *from, shear_mock **mock,
                     shear_error *err) {
    shear_mock_spec m = *from;
    m.n_stamps = s->spec.stamps;
    size_t pixels = (size_t)m.nx * (size_t)m.ny;
    s->pixels = pixels > s->pixels ? pixels : s->pixels;
    return shear_mock_new(mock, &m, err);
}

static int make_mocks(struct sampler *s, shear_error *err) {
    int code = SHEAR_OK;
    for (int i = 0; code == SHEAR_OK && i < s->spec.n_scenes; i++) {
        code = make_mock(s, &s->spec.scenes[i].spec, &s->mocks[i], err);
    }
    if (code == SHEAR_OK && s->spec.noise != NULL) {
        shear_mock_spec bare = *s->spec.noise;
        bare.noise_ratio = 0.0;
        code = make_mock(s, s->spec.noise, &s->noise_mock, err);
        code = code != SHEAR_OK ? code : make_mock(s, &bare, &s->bare_mock, err);
    }
    return code;
}

/* ---- benches ---- */

static bool bench_init(struct bench *b, const struct sampler *s, shear_error *err) {
    size_t n = TILE * s->pixels;
    bool shares = s->spec.noise != NULL;
    b->galaxy = calloc(n, sizeof *b->galaxy);
    b->noise = calloc(n, sizeof *b->noise);
    b->shared = shares ? calloc(n, sizeof *b->shared) : NULL;
    b->shared_n = shares ? calloc(n, sizeof *b->shared_n) : NULL;
    b->bare = shares ? calloc(n, sizeof *b->bare) : NULL;
    b->workspaces = calloc((size_t)s->n_plans + 1, sizeof(shear_workspace *));
    bool made = b->galaxy != NULL && b->noise != NULL && b->workspaces != NULL &&
                (!shares || (b->shared != NULL && b->shared_n != NULL && b->bare != NULL));
    for (int i = 0; made && i < s->n_plans; i++) {
        made = shear_workspace_new(&b->workspaces[i], s->plans[i], err) == SHEAR_OK;
    }
    return made;
}

static void bench_deinit(struct bench *b, int n_plans) {
    for (int i = 0; b->workspaces != NULL && i < n_plans; i++) {
        shear_workspace_free(b->workspaces[i]);
    }
    free(b->workspaces);
    free(b->galaxy);
    free(b->noise);
    free(b->shared);
    free(b->shared_n);
    free(b->bare);
}

static int make_benches(struct sampler *s, shear_error *err) {
    s->n_benches = s->spec.threads > 0 ? s->spec.threads : omp_get_max_threads();
    s->benches = calloc((size_t)s->n_benches, sizeof *s->benches);
    if (s->benches == NULL) {
        return no_memory(err);
    }
    for (int i = 0; i < s->n_benches; i++) {
        if (!bench_init(&s->benches[i], s, err)) {
            return no_memory(err);
        }
    }
    return SHEAR_OK;
}

/* ---- the sampler ---- */

int sampler_new(struct sampler **sampler, const sample_spec *spec, shear_error *err) {
    *sampler = NULL;
    struct sampler *s = calloc(1, sizeof *s);
    if (s == NULL) {
        return no_memory(err);
    }
    s->spec = *spec;
    s->mocks = calloc((size_t)spec->n_scenes + 1, sizeof(shear_mock *));
    s->plans = calloc((size_t)spec->n_series + 1, sizeof(shear_plan *));
    s->plan_of = calloc((size_t)spec->n_series + 1, sizeof *s->plan_of);
    int code =
        s->mocks != NULL && s->plans != NULL && s->plan_of != NULL ? SHEAR_OK : no_memory(err);
    code = code != SHEAR_OK ? code : make_mocks(s, err);
    code = code != SHEAR_OK ? code : make_plans(s, err);
    code = code != SHEAR_OK ? code : make_benches(s, err);
    if (code != SHEAR_OK) {
        sampler_free(s);
        return code;
    }
    *sampler = s;
    return SHEAR_OK;
}

void sampler_free(struct sampler *s) {
    if (s == NULL) {
        return;
    }
    for (int i = 0; s->benches != NULL && i < s->n_benches; i++) {
        bench_deinit(&s->benches[i], s->n_plans);
    }
    for (int i = 0; s->plans != NULL && i < s->n_plans; i++) {
        shear_plan_free(s->plans[i]);
    }
    for (int i = 0; s->mocks != NULL && i < s->spec.n_scenes; i++) {
        shear_mock_free(s->mocks[i]);
    }
    shear_mock_free(s->noise_mock);
    shear_mock_free(s->bare_mock);
    free(s->benches);
    free(s->plans);
    free(s->plan_of);
    free(s->mocks);
    free(s);
}

int sampler_inspect(struct sampler *s, int series, const shear_stamps *stamps, int i,
                    shear_inspection *out, shear_error *err) {
    int plan = s->plan_of[series];
    return shear_inspect(s->plans[plan], s->benches[0].workspaces[plan], stamps, i, out, err);
}

const shear_plan_info *sampler_plan(const struct sampler *s, int series) {
    return shear_plan_get_info(s->plans[s->plan_of[series]]);
}

/* ---- drawing and measuring ---- */

static int draw_shared(const struct sampler *s, struct bench *b, int64_t first, int count,
                       shear_error *err) {
    if (s->spec.noise == NULL) {
        return SHEAR_OK;
    }
    size_t n = (size_t)count * (size_t)s->spec.noise->nx * (size_t)s->spec.noise->ny;
    /* The stamps without noise: the galaxies alone, and zeros that are not needed. */
    int code = shear_mock_stamps(s->bare_mock, first, count, 1, b->bare, b->shared_n, err);
    code = code != SHEAR_OK
               ? code
               : shear_mock_stamps(s->noise_mock, first, count, 1, b->shared, b->shared_n, err);
    for (size_t i = 0; code == SHEAR_OK && i < n; i++) {
        b->shared[i] -= b->bare[i];
    }
    return code;
}

/* Each stamp is a mock of its own. */
static int draw_varied(const struct sampler *s, struct bench *b, int scene, int64_t first,
                       int count, shear_error *err) {
    const struct scene *c = &s->spec.scenes[scene];
    size_t pixels = (size_t)c->spec.nx * (size_t)c->spec.ny;
    int code = SHEAR_OK;
    for (int i = 0; code == SHEAR_OK && i < count; i++) {
        shear_mock_spec m = c->spec;
        shear_mock *mock = NULL;
        m.n_stamps = 1;
        s->spec.vary(s->spec.context, first + i, &m);
        size_t at = (size_t)i * pixels;
        code = shear_mock_new(&mock, &m, err);
        code = code != SHEAR_OK
                   ? code
                   : shear_mock_stamps(mock, 0, 1, 1, b->galaxy + at, b->noise + at, err);
        shear_mock_free(mock);
    }
    return code;
}

static int draw_scene(const struct sampler *s, struct bench *b, int scene, int64_t first, int count,
                      shear_error *err) {
    const struct scene *c = &s->spec.scenes[scene];
    size_t n = (size_t)count * (size_t)c->spec.nx * (size_t)c->spec.ny;
    int code = s->spec.vary != NULL
                   ? draw_varied(s, b, scene, first, count, err)
                   : shear_mock_stamps(s->mocks[scene], first, count, 1, b->galaxy, b->noise, err);
    if (code != SHEAR_OK || c->shared == 0.0) {
        return code;
    }
    for (size_t i = 0; i < n; i++) {
        b->galaxy[i] += c->shared * b->shared[i];
        b->noise[i] += c->shared * b->shared_n[i];
    }
    return SHEAR_OK;
}

struct batch {
    int64_t first;
    int count;
    shear_row *rows; /* [n_series][count] */
};

/* What enters the sums becomes the mean of two measurements of the same stamp. */
static void average(shear_row *a, const shear_row *b) {
    a->n1 = 0.5 * (a->n1 + b->n1);
    a->n2 = 0.5 * (a->n2 + b->n2);
    a->d = 0.5 * (a->d + b->d);
    a->u = 0.5 * (a->u + b->u);
    a->v = 0.5 * (a->v + b->v);
    a->flags |= b->flags;
}

/* All series of the scene that is on the bench; `again`: rows become the mean of before and now. */
static int measure_scene(const struct sampler *s, struct bench *b, int scene,
                         const struct batch *batch, int from, int n, bool again, shear_error *err) {
    const shear_mock_spec *m = &s->spec.scenes[scene].spec;
    const shear_stamps stamps = {.first = batch->first + from,
                                 .count = n,
                                 .nx = m->nx,
                                 .ny = m->ny,
                                 .galaxy = b->galaxy,
                                 .noise = b->noise};
    int code = SHEAR_OK;
    for (int i = 0; code == SHEAR_OK && i < s->spec.n_series; i++) {
        shear_row now[TILE];
        int plan = s->plan_of[i];
        shear_row *rows = batch->rows + (size_t)i * (size_t)batch->count + from;
        if (s->spec.series[i].scene != scene) {
            continue;
        }
        code = shear_measure_range(s->plans[plan], b->workspaces[plan], &stamps, 0, n,
                                   again ? now : rows, err);
        for (int k = 0; code == SHEAR_OK && again && k < n; k++) {
            average(&rows[k], &now[k]);
        }
    }
    return code;
}

/* The galaxy with the other noise, and that noise with the galaxy's. */
static void exchange(const struct sampler *s, struct bench *b, int scene, int n) {
    const struct scene *c = &s->spec.scenes[scene];
    size_t pixels = (size_t)n * (size_t)c->spec.nx * (size_t)c->spec.ny;
    for (size_t i = 0; i < pixels; i++) {
        double d = c->shared * (b->shared_n[i] - b->shared[i]);
        b->galaxy[i] += d;
        b->noise[i] -= d;
    }
}

static int do_tile(const struct sampler *s, struct bench *b, const struct batch *batch, int tile,
                   shear_error *err) {
    int from = tile * TILE;
    int n = batch->count - from < TILE ? batch->count - from : TILE;
    int code = draw_shared(s, b, batch->first + from, n, err);
    for (int scene = 0; code == SHEAR_OK && scene < s->spec.n_scenes; scene++) {
        code = draw_scene(s, b, scene, batch->first + from, n, err);
        code = code != SHEAR_OK ? code : measure_scene(s, b, scene, batch, from, n, false, err);
        if (code == SHEAR_OK && s->spec.exchange && s->spec.scenes[scene].shared != 0.0) {
            exchange(s, b, scene, n);
            code = measure_scene(s, b, scene, batch, from, n, true, err);
        }
    }
    return code;
}

int sampler_rows(struct sampler *s, int64_t first, int count, shear_row *rows, shear_error *err) {
    const struct batch batch = {first, count, rows};
    int tiles = (count + TILE - 1) / TILE;
    int failed_tile = tiles;
    shear_error failure = {0};
#pragma omp parallel for schedule(dynamic) num_threads(s->n_benches)
    for (int tile = 0; tile < tiles; tile++) {
        shear_error e = {0};
        if (do_tile(s, &s->benches[omp_get_thread_num()], &batch, tile, &e) != 0) {
#pragma omp critical(sampler_failure)
            if (tile < failed_tile) {
                failed_tile = tile;
                failure = e;
            }
        }
    }
    if (failed_tile < tiles) {
        return shear_fail(err, failure.code, failure.advice, "%s", failure.message);
    }
    return SHEAR_OK;
}
