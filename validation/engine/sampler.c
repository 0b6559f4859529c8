/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drawing and measuring the stamps of a sample in tiles, by all threads. */
#include "engine/must.h"
#include "engine/sample.h"

#include <assert.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* Stamps that a thread draws at once: a multiple of 4, so that rotated copies stay together. */
enum { TILE = 8 };

/* The images, in one allocation, and the workspaces of one thread. */
typedef struct worker {
    double *galaxy, *noise;           /* [TILE][ny][nx] of the current scene */
    double *shared, *shared_n, *bare; /* the same size: shared noise of both stamps; scratch */
    shear_workspace **workspaces;     /* [n_plans] */
} worker;

struct sampler {
    sample of;
    int64_t stamps;
    shear_mock **mocks;                 /* [n_scenes] */
    shear_mock *noise_mock, *bare_mock; /* with and without the shared noise */
    int n_plans;
    shear_plan **plans; /* [n_plans <= n_series] */
    int *plan_of;       /* [n_series] */
    size_t pixels;      /* of a stamp of the largest scene */
    int n_workers;
    worker *workers;
};

static size_t pixels_of(const shear_mock_spec *m) {
    return (size_t)m->nx * (size_t)m->ny;
}

/* ---- mocks ---- */

shear_mock *sampler_mock(const shear_mock_spec *spec, int64_t n) {
    shear_mock_spec m = *spec;
    shear_mock *mock = NULL;
    m.n_stamps = n;
    must(shear_mock_new(&mock, &m, &must_error));
    return mock;
}

double *sampler_draw(const shear_mock_spec *spec, int n) {
    const size_t size = (size_t)n * pixels_of(spec);
    CLEANUP(shear_mock_release) shear_mock *mock = sampler_mock(spec, n);
    double *stamps = must_allocate(2 * size, sizeof *stamps, "stamps");
    must(shear_mock_stamps(mock, 0, n, 1, stamps, stamps + size, &must_error));
    return stamps;
}

/* ---- plans ---- */

static void resolve_settings(shear_settings *s, const shear_mock_spec *m) {
    if (isnan(s->beta_px))
        s->beta_px = fmax(s->beta_ratio * m->r_psf_px, s->beta_floor_px);
    const bool paper = s->filter == SHEAR_FILTER_PAPER || s->filter == SHEAR_FILTER_AUTO ||
                       s->filter == SHEAR_FILTER_R_GAL;
    if (paper && isnan(s->core_px)) {
        s->filter = SHEAR_FILTER_AUTO; /* required for an explicit core */
        s->core_px = m->r_gal_px + 4.0 * s->beta_px;
        s->width_px = isnan(s->width_px) ? s->beta_px : s->width_px;
    }
}

/* The input of a series' plan: a mock with the PSF sampling of the series. */
typedef struct basis {
    shear_mock_spec mock;
    shear_settings settings;
} basis;

static basis basis_of(const sampler *s, int i) {
    const series *of = &s->of.series[i];
    basis b = {s->of.scenes[of->scene].spec, of->settings};
    b.mock.oversample = of->psf_oversample > 0 ? of->psf_oversample : b.mock.oversample;
    resolve_settings(&b.settings, &b.mock);
    return b;
}

/* Return whether all members on which a plan depends are equal. */
static bool same_plan(const basis *a, const basis *b) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    bool same = a->mock.nx == b->mock.nx && a->mock.ny == b->mock.ny &&
                a->mock.psf == b->mock.psf && a->mock.r_psf_px == b->mock.r_psf_px &&
                a->mock.psf_angle_deg == b->mock.psf_angle_deg &&
                a->mock.oversample == b->mock.oversample && a->mock.psf_size == b->mock.psf_size;
    for (size_t i = 0; same && i < n; i++) {
        char ta[64];
        char tb[64];
        same = strcmp(shear_settings_format(&a->settings, &table[i], ta, sizeof ta),
                      shear_settings_format(&b->settings, &table[i], tb, sizeof tb)) == 0;
    }
    return same;
}

shear_plan *sampler_plan(const shear_mock *mock, const shear_settings *settings) {
    const shear_geometry *g = &shear_mock_get_info(mock)->geometry;
    const size_t n = (size_t)g->psf_nx * (size_t)g->psf_ny;
    CLEANUP(release_free) double *psf = must_allocate(n, sizeof *psf, "a PSF");
    shear_plan *plan = NULL;
    shear_mock_psf_image(mock, 0, psf);
    must(shear_plan_new(&plan,
                        &(shear_plan_request){.settings = settings, .geometry = *g, .psf = psf},
                        &must_error));
    return plan;
}

/* Return the index of an equal plan of an earlier series, or of a new plan. */
static int find_plan(sampler *s, int i) {
    const basis b = basis_of(s, i);
    for (int k = 0; k < i; k++) {
        const basis earlier = basis_of(s, k);
        if (same_plan(&earlier, &b))
            return s->plan_of[k];
    }
    CLEANUP(shear_mock_release) shear_mock *mock = sampler_mock(&b.mock, s->stamps);
    s->plans[s->n_plans] = sampler_plan(mock, &b.settings);
    return s->n_plans++;
}

/* ---- the sampler ---- */

static shear_mock *new_mock(sampler *s, const shear_mock_spec *m) {
    s->pixels = pixels_of(m) > s->pixels ? pixels_of(m) : s->pixels;
    return sampler_mock(m, s->stamps);
}

static void make_mocks(sampler *s) {
    for (int i = 0; i < s->of.n_scenes; i++)
        s->mocks[i] = new_mock(s, &s->of.scenes[i].spec);
    if (s->of.noise != NULL) {
        shear_mock_spec bare = *s->of.noise;
        bare.noise_ratio = 0.0;
        s->noise_mock = new_mock(s, s->of.noise);
        s->bare_mock = new_mock(s, &bare);
    }
}

static void worker_init(worker *w, const sampler *s) {
    double **const images[] = {&w->galaxy, &w->noise, &w->shared, &w->shared_n, &w->bare};
    must_allocate_arrays(sizeof images / sizeof images[0], images, TILE * s->pixels, "stamps");
    w->workspaces = must_allocate((size_t)s->n_plans, sizeof(shear_workspace *), "workspaces");
    for (int i = 0; i < s->n_plans; i++)
        must(shear_workspace_new(&w->workspaces[i], s->plans[i], &must_error));
}

static void worker_deinit(worker *w, int n_plans) {
    for (int i = 0; i < n_plans; i++)
        shear_workspace_free(w->workspaces[i]);
    free(w->workspaces);
    free(w->galaxy);
}

sampler *sampler_new(const sample *what, int64_t stamps, int threads) {
    sampler *s = must_allocate(1, sizeof *s, "a sample");
    const size_t n = (size_t)what->n_series;
    *s = (sampler){.of = *what, .stamps = stamps};
    s->mocks = must_allocate((size_t)what->n_scenes, sizeof(shear_mock *), "a sample");
    s->plans = must_allocate(n, sizeof(shear_plan *), "a sample");
    s->plan_of = must_allocate(n, sizeof *s->plan_of, "a sample");
    make_mocks(s);
    for (int i = 0; i < what->n_series; i++)
        s->plan_of[i] = find_plan(s, i);
    s->n_workers = threads > 0 ? threads : omp_get_max_threads();
    s->workers = must_allocate((size_t)s->n_workers, sizeof *s->workers, "a sample");
    for (int i = 0; i < s->n_workers; i++)
        worker_init(&s->workers[i], s);
    return s;
}

void sampler_free(sampler *s) {
    if (s == NULL)
        return;
    for (int i = 0; i < s->n_workers; i++)
        worker_deinit(&s->workers[i], s->n_plans);
    for (int i = 0; i < s->n_plans; i++)
        shear_plan_free(s->plans[i]);
    for (int i = 0; i < s->of.n_scenes; i++)
        shear_mock_free(s->mocks[i]);
    shear_mock_free(s->noise_mock);
    shear_mock_free(s->bare_mock);
    free(s->workers);
    free(s->plans);
    free(s->plan_of);
    free(s->mocks);
    free(s);
}

void sampler_inspect(sampler *s, int i_series, const shear_stamps *stamps, int i,
                     shear_inspection *out) {
    const int plan = s->plan_of[i_series];
    must(
        shear_inspect(s->plans[plan], s->workers[0].workspaces[plan], stamps, i, out, &must_error));
}

/* ---- drawing and measuring ---- */

static void draw_shared(const sampler *s, worker *w, int64_t first, int count) {
    const size_t n = (size_t)count * pixels_of(s->of.noise);
    /* The stamps without noise: the galaxies, and zeros that are not used. */
    must(shear_mock_stamps(s->bare_mock, first, count, 1, w->bare, w->shared_n, &must_error));
    must(shear_mock_stamps(s->noise_mock, first, count, 1, w->shared, w->shared_n, &must_error));
    for (size_t i = 0; i < n; i++)
        w->shared[i] -= w->bare[i];
}

/* Draw stamps each of which is a mock of its own. */
static void draw_varied(const sampler *s, worker *w, const scene *c, int64_t first, int count) {
    for (int i = 0; i < count; i++) {
        const size_t at = (size_t)i * pixels_of(&c->spec);
        shear_mock_spec m = c->spec;
        s->of.vary(s->of.context, first + i, &m);
        CLEANUP(shear_mock_release) shear_mock *mock = sampler_mock(&m, 1);
        must(shear_mock_stamps(mock, 0, 1, 1, w->galaxy + at, w->noise + at, &must_error));
    }
}

static void draw_scene(const sampler *s, worker *w, int i_scene, int64_t first, int count) {
    const scene *c = &s->of.scenes[i_scene];
    const size_t n = (size_t)count * pixels_of(&c->spec);
    if (s->of.vary != NULL) {
        draw_varied(s, w, c, first, count);
    } else {
        must(shear_mock_stamps(s->mocks[i_scene], first, count, 1, w->galaxy, w->noise,
                               &must_error));
    }
    for (size_t i = 0; c->shared != 0.0 && i < n; i++) {
        w->galaxy[i] += c->shared * w->shared[i];
        w->noise[i] += c->shared * w->shared_n[i];
    }
}

typedef struct batch {
    int64_t first;
    int count;
    shear_row *rows; /* [n_series][count] */
} batch;

/* Set the numbers that enter the sums to the mean of two measurements of the same stamp. */
static void average(shear_row *a, const shear_row *b) {
    a->n1 = 0.5 * (a->n1 + b->n1);
    a->n2 = 0.5 * (a->n2 + b->n2);
    a->d = 0.5 * (a->d + b->d);
    a->u = 0.5 * (a->u + b->u);
    a->v = 0.5 * (a->v + b->v);
    a->flags |= b->flags;
}

/* Measure all series of the scene that the worker holds. `again`: rows become the mean of the
 * previous and this measurement. */
static void measure_scene(const sampler *s, worker *w, int i_scene, const batch *b, int from, int n,
                          bool again) {
    const shear_mock_spec *m = &s->of.scenes[i_scene].spec;
    const shear_stamps stamps = {.first = b->first + from,
                                 .count = n,
                                 .nx = m->nx,
                                 .ny = m->ny,
                                 .galaxy = w->galaxy,
                                 .noise = w->noise};
    assert(n <= TILE);
    for (int i = 0; i < s->of.n_series; i++) {
        shear_row now[TILE];
        const int plan = s->plan_of[i];
        shear_row *rows = b->rows + (size_t)i * (size_t)b->count + from;
        if (s->of.series[i].scene != i_scene)
            continue;
        must(shear_measure_range(s->plans[plan], w->workspaces[plan], &stamps, 0, n,
                                 again ? now : rows, &must_error));
        for (int k = 0; again && k < n; k++)
            average(&rows[k], &now[k]);
    }
}

/* Exchange the noises: the galaxy gets the other noise, and the noise stamp the galaxy's. */
static void exchange(worker *w, const scene *c, int n) {
    const size_t pixels = (size_t)n * pixels_of(&c->spec);
    for (size_t i = 0; i < pixels; i++) {
        const double d = c->shared * (w->shared_n[i] - w->shared[i]);
        w->galaxy[i] += d;
        w->noise[i] -= d;
    }
}

static void do_tile(const sampler *s, worker *w, const batch *b, int tile) {
    const int from = tile * TILE;
    const int n = b->count - from < TILE ? b->count - from : TILE;
    if (s->of.noise != NULL)
        draw_shared(s, w, b->first + from, n);
    for (int i = 0; i < s->of.n_scenes; i++) {
        draw_scene(s, w, i, b->first + from, n);
        measure_scene(s, w, i, b, from, n, false);
        if (s->of.exchange && s->of.scenes[i].shared != 0.0) {
            exchange(w, &s->of.scenes[i], n);
            measure_scene(s, w, i, b, from, n, true);
        }
    }
}

void sampler_rows(sampler *s, int64_t first, int count, shear_row *rows) {
    const batch b = {first, count, rows};
    const int tiles = (count + TILE - 1) / TILE;
#pragma omp parallel for schedule(dynamic) num_threads(s->n_workers)
    for (int tile = 0; tile < tiles; tile++)
        do_tile(s, &s->workers[omp_get_thread_num()], &b, tile);
}
