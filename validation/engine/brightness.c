/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/brightness.h"
#include "engine/must.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>

enum { TILE = 4, PROBES = 64 };

/* splitmix64: one number of [0, 1) for (seed, index). */
static double uniform(uint64_t seed, uint64_t index) {
    uint64_t z = seed * UINT64_C(0x9E3779B97F4A7C15) + (index + 1) * UINT64_C(0xD1B54A32D192ED03);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    z ^= z >> 31;
    return (double)(z >> 11) / 9007199254740992.0;
}

double brightness_flux(const brightness *b, uint64_t seed, int64_t galaxy) {
    const double u = uniform(seed, (uint64_t)galaxy);
    const double power = 1.0 - b->slope;
    if (fabs(power) < 1e-9) {
        return pow(b->range, u);
    }
    return pow(1.0 + u * (pow(b->range, power) - 1.0), 1.0 / power);
}

static int no_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, "use fewer threads", "out of memory for stamps");
}

int brightness_sigma(const shear_mock_spec *spec, double snr, double *sigma, shear_error *err) {
    shear_mock_spec m = *spec;
    shear_mock *mock = NULL;
    m.n_stamps = PROBES;
    m.rotate = 1;
    const size_t n = PROBES * (size_t)m.nx * (size_t)m.ny;
    int code = SHEAR_OK;
    double *galaxy = memory_new(2 * n, sizeof *galaxy, "stamps", &code, err);
    code = code != SHEAR_OK ? code : shear_mock_new(&mock, &m, err);
    code = code != SHEAR_OK ? code : shear_mock_stamps(mock, 0, PROBES, 1, galaxy, galaxy + n, err);
    double sum = 0.0;
    for (size_t i = 0; code == SHEAR_OK && i < n; i++) {
        sum += galaxy[i] * galaxy[i];
    }
    *sigma = sqrt(sum / PROBES) / snr;
    shear_mock_free(mock);
    free(galaxy);
    return code;
}

/* One thread's images [TILE][ny][nx] and scratch. */
typedef struct desk {
    shear_workspace *ws;
    double *bare, *none;    /* galaxies without noise; their empty noise stamps */
    double *first, *second; /* unit noise of galaxy and noise stamp */
    double *galaxy, *noise; /* what is measured */
    double *images;         /* behind them all */
} desk;

typedef struct bright_stamps {
    shear_mock *bare, *noisy; /* the latter in noise of sigma 1 */
    shear_plan *plan;
    size_t pixels;
    int n_desks;
    desk *desks;
} bright_stamps;

static bool desk_init(desk *d, const shear_plan *plan, size_t pixels, shear_error *err) {
    const size_t n = TILE * pixels;
    d->images = calloc(6 * n, sizeof *d->images);
    double **const parts[] = {&d->bare, &d->none, &d->first, &d->second, &d->galaxy, &d->noise};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        *parts[i] = d->images + i * n;
    }
    return d->images != NULL && shear_workspace_new(&d->ws, plan, err) == SHEAR_OK;
}

static int make_plan(bright_stamps *s, const shear_settings *settings, shear_error *err) {
    const shear_geometry *g = &shear_mock_get_info(s->bare)->geometry;
    double *psf = calloc((size_t)g->psf_nx * (size_t)g->psf_ny, sizeof *psf);
    int code = psf != NULL ? SHEAR_OK : no_memory(err);
    if (code == SHEAR_OK) {
        shear_mock_psf_image(s->bare, 0, psf);
        code = shear_plan_new(
            &s->plan, &(shear_plan_request){.settings = settings, .geometry = *g, .psf = psf}, err);
    }
    free(psf);
    return code;
}

static int make_desks(bright_stamps *s, int threads, shear_error *err) {
    s->n_desks = threads > 0 ? threads : omp_get_max_threads();
    s->desks = calloc((size_t)s->n_desks, sizeof *s->desks);
    for (int i = 0; s->desks != NULL && i < s->n_desks; i++) {
        if (!desk_init(&s->desks[i], s->plan, s->pixels, err)) {
            return no_memory(err);
        }
    }
    return s->desks != NULL ? SHEAR_OK : no_memory(err);
}

int bright_stamps_new(bright_stamps **out, const shear_mock_spec *mock,
                      const shear_settings *settings, int threads, shear_error *err) {
    shear_mock_spec noisy = *mock;
    noisy.white_sigma = 1.0;
    bright_stamps *s = calloc(1, sizeof *s);
    *out = NULL;
    if (s == NULL) {
        return no_memory(err);
    }
    s->pixels = (size_t)mock->nx * (size_t)mock->ny;
    int code = shear_mock_new(&s->bare, mock, err);
    code = code != SHEAR_OK ? code : shear_mock_new(&s->noisy, &noisy, err);
    code = code != SHEAR_OK ? code : make_plan(s, settings, err);
    code = code != SHEAR_OK ? code : make_desks(s, threads, err);
    if (code != SHEAR_OK) {
        bright_stamps_free(s);
        return code;
    }
    *out = s;
    return SHEAR_OK;
}

void bright_stamps_free(bright_stamps *s) {
    if (s == NULL) {
        return;
    }
    for (int i = 0; s->desks != NULL && i < s->n_desks; i++) {
        shear_workspace_free(s->desks[i].ws);
        free(s->desks[i].images);
    }
    free(s->desks);
    shear_plan_free(s->plan);
    shear_mock_free(s->bare);
    shear_mock_free(s->noisy);
    free(s);
}

const shear_plan_info *bright_stamps_plan(const bright_stamps *s) {
    return shear_plan_get_info(s->plan);
}

struct batch {
    int64_t first;
    int count, n;
    const brightness *cases;
    shear_row *rows; /* [n][count] */
};

/* Galaxies without noise, and unit noise as the difference from those in noise. */
static int draw(const bright_stamps *s, desk *d, int64_t first, int count, shear_error *err) {
    int code = shear_mock_stamps(s->bare, first, count, 1, d->bare, d->none, err);
    code = code != SHEAR_OK
               ? code
               : shear_mock_stamps(s->noisy, first, count, 1, d->first, d->second, err);
    for (size_t i = 0; code == SHEAR_OK && i < (size_t)count * s->pixels; i++) {
        d->first[i] -= d->bare[i];
    }
    return code;
}

/* The factor flux^2 on all moments. */
static void scale_row(shear_row *row, double flux) {
    double *const moments[] = {&row->n1,      &row->n2,       &row->d,        &row->u,
                               &row->v,       &row->m20,      &row->m02,      &row->m11,
                               &row->m4,      &row->cross_n1, &row->cross_n2, &row->cross_d,
                               &row->cross_u, &row->cross_v};
    for (size_t i = 0; i < sizeof moments / sizeof moments[0]; i++) {
        *moments[i] *= flux * flux;
    }
    row->flux *= flux;
}

static int measure_case(const bright_stamps *s, desk *d, const struct batch *b, int from, int count,
                        int k, shear_error *err) {
    const brightness *c = &b->cases[k];
    const shear_mock_spec *m = shear_mock_get_spec(s->bare);
    const shear_stamps stamps = {
        .count = count, .nx = m->nx, .ny = m->ny, .galaxy = d->galaxy, .noise = d->noise};
    const size_t at = (size_t)k * (size_t)b->count + (size_t)from;
    double flux[TILE];
    for (int i = 0; i < count; i++) {
        flux[i] = brightness_flux(c, m->seed, (b->first + from + i) / m->rotate);
        for (size_t p = (size_t)i * s->pixels; p < (size_t)(i + 1) * s->pixels; p++) {
            d->galaxy[p] = d->bare[p] + c->sigma / flux[i] * d->first[p];
            d->noise[p] = c->sigma / flux[i] * d->second[p];
        }
    }
    const int code = shear_measure_range(s->plan, d->ws, &stamps, 0, count, b->rows + at, err);
    for (int i = 0; code == SHEAR_OK && i < count; i++) {
        scale_row(&b->rows[at + (size_t)i], flux[i]);
    }
    return code;
}

static int do_tile(const bright_stamps *s, desk *d, const struct batch *b, int tile,
                   shear_error *err) {
    const int from = tile * TILE;
    const int count = b->count - from < TILE ? b->count - from : TILE;
    int code = draw(s, d, b->first + from, count, err);
    for (int k = 0; code == SHEAR_OK && k < b->n; k++) {
        code = measure_case(s, d, b, from, count, k, err);
    }
    return code;
}

int bright_stamps_rows(bright_stamps *s, int64_t first, int count, int n, const brightness *cases,
                       shear_row *rows, shear_error *err) {
    const struct batch batch = {first, count, n, cases, rows};
    const int tiles = (count + TILE - 1) / TILE;
    int failed = SHEAR_OK;
    shear_error failure = {0};
#pragma omp parallel for schedule(dynamic) num_threads(s->n_desks)
    for (int tile = 0; tile < tiles; tile++) {
        shear_error e = {0};
        const int code = do_tile(s, &s->desks[omp_get_thread_num()], &batch, tile, &e);
        if (code != SHEAR_OK) {
#pragma omp critical(bright_stamps_failure)
            {
                failed = code;
                failure = e;
            }
        }
    }
    return failed != 0 ? shear_fail(err, failed, failure.advice, "%s", failure.message) : SHEAR_OK;
}
