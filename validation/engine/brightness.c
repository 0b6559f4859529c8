/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/brightness.h"

#include "engine/must.h"
#include "engine/population.h"
#include "engine/sample.h"

#include <assert.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>

enum { TILE = 4, PROBES = 64 };

double brightness_flux(const brightness *b, uint64_t seed, int64_t galaxy) {
    const double u = dice_mixed(seed * UINT64_C(0x9E3779B97F4A7C15) +
                                ((uint64_t)galaxy + 1) * UINT64_C(0xD1B54A32D192ED03));
    const double power = 1.0 - b->slope;
    if (fabs(power) < 1e-9)
        return pow(b->range, u);
    return pow(1.0 + u * (pow(b->range, power) - 1.0), 1.0 / power);
}

double brightness_sigma(const shear_mock_spec *spec, double snr) {
    shear_mock_spec m = *spec;
    m.rotate = 1;
    CLEANUP(release_free) double *galaxy = sampler_draw(&m, PROBES);
    double sum = 0.0;
    for (size_t i = 0; i < PROBES * (size_t)m.nx * (size_t)m.ny; i++)
        sum += galaxy[i] * galaxy[i];
    return sqrt(sum / PROBES) / snr;
}

/* The images of one thread, [TILE][ny][nx] each, and scratch memory. */
typedef struct worker {
    shear_workspace *ws;
    double *bare, *none;    /* galaxies without noise; their empty noise stamps */
    double *first, *second; /* unit noise of galaxy and noise stamps */
    double *galaxy, *noise; /* the input of the measurement */
} worker;

struct brightness_stamps {
    shear_mock *bare, *noisy; /* the latter with noise of sigma 1 */
    shear_plan *plan;
    size_t pixels;
    int n_workers;
    worker *workers;
};

static void worker_init(worker *w, const brightness_stamps *s) {
    double **const parts[] = {&w->bare, &w->none, &w->first, &w->second, &w->galaxy, &w->noise};
    must_allocate_arrays(sizeof parts / sizeof parts[0], parts, TILE * s->pixels, "stamps");
    must(shear_workspace_new(&w->ws, s->plan, &must_error));
}

brightness_stamps *brightness_stamps_new(const shear_mock_spec *mock,
                                         const shear_settings *settings, int threads) {
    shear_mock_spec noisy = *mock;
    brightness_stamps *s = must_allocate(1, sizeof *s, "stamps");
    noisy.white_sigma = 1.0;
    s->bare = sampler_mock(mock, mock->n_stamps);
    s->noisy = sampler_mock(&noisy, mock->n_stamps);
    s->pixels = (size_t)mock->nx * (size_t)mock->ny;
    s->plan = sampler_plan(s->bare, settings);
    s->n_workers = threads > 0 ? threads : omp_get_max_threads();
    s->workers = must_allocate((size_t)s->n_workers, sizeof *s->workers, "stamps");
    for (int i = 0; i < s->n_workers; i++)
        worker_init(&s->workers[i], s);
    return s;
}

void brightness_stamps_free(brightness_stamps *s) {
    if (s == NULL)
        return;
    for (int i = 0; i < s->n_workers; i++) {
        shear_workspace_free(s->workers[i].ws);
        free(s->workers[i].bare);
    }
    free(s->workers);
    shear_plan_free(s->plan);
    shear_mock_free(s->bare);
    shear_mock_free(s->noisy);
    free(s);
}

double brightness_stamps_beta_px(const brightness_stamps *s) {
    return shear_plan_get_info(s->plan)->beta_px;
}

typedef struct batch {
    int64_t first;
    int count, n;
    const brightness *cases;
    shear_row *rows; /* [n][count] */
} batch;

/* Draw galaxies without noise, and unit noise as the difference to the same galaxies with noise. */
static void draw(const brightness_stamps *s, worker *w, int64_t first, int count) {
    must(shear_mock_stamps(s->bare, first, count, 1, w->bare, w->none, &must_error));
    must(shear_mock_stamps(s->noisy, first, count, 1, w->first, w->second, &must_error));
    for (size_t i = 0; i < (size_t)count * s->pixels; i++)
        w->first[i] -= w->bare[i];
}

/* Multiply all moments by flux^2. */
static void scale_row(shear_row *row, double flux) {
    double *const moments[] = {&row->n1,      &row->n2,       &row->d,        &row->u,
                               &row->v,       &row->m20,      &row->m02,      &row->m11,
                               &row->m4,      &row->cross_n1, &row->cross_n2, &row->cross_d,
                               &row->cross_u, &row->cross_v};
    for (size_t i = 0; i < sizeof moments / sizeof moments[0]; i++)
        *moments[i] *= flux * flux;
    row->flux *= flux;
}

static void measure_case(const brightness_stamps *s, worker *w, const batch *b, int from, int count,
                         int k) {
    const brightness *c = &b->cases[k];
    const shear_mock_spec *m = shear_mock_get_spec(s->bare);
    const shear_stamps stamps = {
        .count = count, .nx = m->nx, .ny = m->ny, .galaxy = w->galaxy, .noise = w->noise};
    shear_row *rows = b->rows + (size_t)k * (size_t)b->count + from;
    double flux[TILE];
    assert(count <= TILE);
    for (int i = 0; i < count; i++) {
        flux[i] = brightness_flux(c, m->seed, (b->first + from + i) / m->rotate);
        for (size_t p = (size_t)i * s->pixels; p < (size_t)(i + 1) * s->pixels; p++) {
            w->galaxy[p] = w->bare[p] + c->sigma / flux[i] * w->first[p];
            w->noise[p] = c->sigma / flux[i] * w->second[p];
        }
    }
    must(shear_measure_range(s->plan, w->ws, &stamps, 0, count, rows, &must_error));
    for (int i = 0; i < count; i++)
        scale_row(&rows[i], flux[i]);
}

void brightness_stamps_rows(brightness_stamps *s, int64_t first, int count, int n,
                            const brightness *cases, shear_row *rows) {
    const batch b = {first, count, n, cases, rows};
#pragma omp parallel for schedule(dynamic) num_threads(s->n_workers)
    for (int from = 0; from < count; from += TILE) {
        worker *w = &s->workers[omp_get_thread_num()];
        const int in_tile = count - from < TILE ? count - from : TILE;
        draw(s, w, first + from, in_tile);
        for (int k = 0; k < n; k++)
            measure_case(s, w, &b, from, in_tile, k);
    }
}
