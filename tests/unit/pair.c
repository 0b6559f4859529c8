/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pair.h"

#include "gaussian.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

void pair_init(pair *p, int nx, int ny, int psf_nx, int psf_ny, int psf_oversample) {
    const size_t pixels = (size_t)nx * (size_t)ny;
    *p = (pair){.geometry = {.nx = nx,
                             .ny = ny,
                             .psf_nx = psf_nx,
                             .psf_ny = psf_ny,
                             .psf_oversample = psf_oversample}};
    shear_settings_init(&p->settings);
    p->settings.artefacts = SHEAR_ARTEFACTS_KEEP; /* a law holds for images of any kind */
    p->galaxy = calloc(pixels, sizeof(double));
    p->noise = calloc(pixels, sizeof(double));
    p->psf = calloc((size_t)psf_nx * (size_t)psf_ny, sizeof(double));
    assert_true(p->galaxy != NULL && p->noise != NULL && p->psf != NULL);
}

void pair_deinit(pair *p) {
    free(p->galaxy);
    free(p->noise);
    free(p->psf);
}

const char *const pair_methods[PAIR_METHODS] = {
    "none", "bilinear", "bicubic", "spline", "log-bilinear", "log-bicubic", "log-spline"};

void pair_set(pair *p, const char *name, const char *value) {
    shear_error err = {0};
    if (shear_settings_set(&p->settings, name, value, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
}

void pair_draw(pair *p, double r_psf, uint64_t seed) {
    const shear_geometry *g = &p->geometry;
    const size_t pixels = (size_t)g->nx * (size_t)g->ny;
    draw_blobs(p->galaxy, g->nx, g->ny, 4, 2.0, seed++);
    for (size_t i = 0; i < pixels; i++) {
        p->galaxy[i] += 0.01 + 0.04 * uniform(&seed);
        p->noise[i] = 0.01 + 0.04 * uniform(&seed);
    }
    const double stretch = 1.0 + 0.2 * uniform(&seed);
    const gaussian psf = {.amplitude = 1.0,
                          .xx = r_psf * r_psf * stretch,
                          .yy = r_psf * r_psf / stretch,
                          .xy = 0.15 * r_psf * r_psf,
                          .x0 = (0.45 + 0.1 * uniform(&seed)) * g->psf_nx / g->psf_oversample,
                          .y0 = (0.45 + 0.1 * uniform(&seed)) * g->psf_ny / g->psf_oversample};
    gaussian_draw(&psf, g->psf_nx, g->psf_ny, (int)g->psf_oversample, p->psf);
}

static int try_info(const pair *p, shear_row *row, shear_plan_info *info, shear_error *err) {
    shear_plan *plan = NULL;
    shear_workspace *ws = NULL;
    int code = shear_plan_new(
        &plan,
        &(shear_plan_request){.settings = &p->settings, .geometry = p->geometry, .psf = p->psf},
        err);
    if (code == SHEAR_OK)
        code = shear_workspace_new(&ws, plan, err);
    if (code == SHEAR_OK) {
        const shear_stamps stamps = {.count = 1,
                                     .nx = p->geometry.nx,
                                     .ny = p->geometry.ny,
                                     .galaxy = p->galaxy,
                                     .noise = p->noise};
        *info = *shear_plan_get_info(plan);
        code = shear_measure(plan, ws, &stamps, 0, row, err);
    }
    shear_workspace_free(ws);
    shear_plan_free(plan);
    return code;
}

int pair_try(const pair *p, shear_row *row, shear_error *err) {
    shear_plan_info info;
    return try_info(p, row, &info, err);
}

shear_row pair_measure_info(const pair *p, shear_plan_info *info) {
    shear_row row = {0};
    shear_error err = {0};
    if (try_info(p, &row, info, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    assert_int_equal(row.flags, 0);
    return row;
}

shear_row pair_measure(const pair *p) {
    shear_plan_info info;
    return pair_measure_info(p, &info);
}

double uniform(uint64_t *state) {
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

void draw_blobs(double *out, int nx, int ny, int n, double sigma, uint64_t seed) {
    const size_t pixels = (size_t)nx * (size_t)ny;
    double *one = calloc(pixels, sizeof *one);
    assert_non_null(one);
    for (size_t i = 0; i < pixels; i++)
        out[i] = 0.0;
    for (int b = 0; b < n; b++) {
        const double s2 = sigma * sigma * (0.8 + 0.4 * uniform(&seed));
        const gaussian blob = {.amplitude = 0.5 + uniform(&seed),
                               .xx = s2 * (0.8 + 0.4 * uniform(&seed)),
                               .yy = s2 * (0.8 + 0.4 * uniform(&seed)),
                               .xy = s2 * 0.2 * (uniform(&seed) - 0.5),
                               .x0 = nx * (0.42 + 0.16 * uniform(&seed)),
                               .y0 = ny * (0.42 + 0.16 * uniform(&seed))};
        gaussian_draw(&blob, nx, ny, 1, one);
        for (size_t i = 0; i < pixels; i++)
            out[i] += one[i];
    }
    free(one);
}
