/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "batch.h"

#include "pair.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void *zeros(size_t n, size_t size) {
    void *p = calloc(n, size);
    assert_non_null(p);
    return p;
}

void batch_init(batch *b, int count, const shear_geometry *geometry, double r_psf, uint64_t seed) {
    const size_t n = (size_t)count;
    const size_t pixels = (size_t)geometry->nx * (size_t)geometry->ny;
    const size_t samples = (size_t)geometry->psf_nx * (size_t)geometry->psf_ny;
    *b = (batch){.geometry = *geometry,
                 .count = count,
                 .galaxy = zeros(n * pixels, sizeof(double)),
                 .noise = zeros(n * pixels, sizeof(double)),
                 .psf = zeros(n * samples, sizeof(double)),
                 .weight = zeros(n, sizeof(double)),
                 .r_gal = zeros(n, sizeof(double)),
                 .psf_index = zeros(n, sizeof(int32_t)),
                 .mask = zeros(n, sizeof(int32_t))};
    pair p;
    pair_init(&p, geometry->nx, geometry->ny, geometry->psf_nx, geometry->psf_ny,
              (int)geometry->psf_oversample);
    for (size_t i = 0; i < n; i++) {
        pair_draw(&p, r_psf, seed + 100 * i);
        memcpy(b->galaxy + i * pixels, p.galaxy, pixels * sizeof(double));
        memcpy(b->noise + i * pixels, p.noise, pixels * sizeof(double));
        memcpy(b->psf + i * samples, p.psf, samples * sizeof(double));
        b->weight[i] = 0.5 + uniform(&seed);
        b->r_gal[i] = 2.0 + 2.0 * uniform(&seed);
        b->psf_index[i] = (int32_t)((double)count * uniform(&seed));
    }
    pair_deinit(&p);
}

void batch_deinit(batch *b) {
    free(b->galaxy);
    free(b->noise);
    free(b->psf);
    free(b->weight);
    free(b->r_gal);
    free(b->psf_index);
    free(b->mask);
}

shear_stamps batch_plain(const batch *b) {
    return (shear_stamps){.count = b->count,
                          .nx = b->geometry.nx,
                          .ny = b->geometry.ny,
                          .galaxy = b->galaxy,
                          .noise = b->noise};
}

shear_stamps batch_full(const batch *b) {
    shear_stamps s = batch_plain(b);
    s.n_psf = b->count;
    s.psf = b->psf;
    s.psf_index = b->psf_index;
    s.weight = b->weight;
    s.r_gal = b->r_gal;
    s.mask = b->mask;
    return s;
}

shear_plan *batch_plan(const batch *b, const shear_settings *settings, bool own_psf,
                       bool has_r_gal) {
    shear_plan *plan = NULL;
    shear_error err = {0};
    double r_psf = NAN;
    assert_int_equal(shear_psf_radius(b->psf, b->geometry.psf_nx, b->geometry.psf_ny,
                                      b->geometry.psf_oversample, &r_psf, &err),
                     SHEAR_OK);
    if (shear_plan_new(&plan,
                       &(shear_plan_request){.settings = settings,
                                             .geometry = b->geometry,
                                             .psf = own_psf ? NULL : b->psf,
                                             .r_psf_px = r_psf,
                                             .has_r_gal = has_r_gal},
                       &err) != SHEAR_OK) {
        fail_msg("%s", err.message);
    }
    return plan;
}

void batch_measure(const shear_plan *plan, const shear_stamps *stamps, shear_row *rows) {
    shear_workspace *ws = NULL;
    shear_error err = {0};
    assert_int_equal(shear_workspace_new(&ws, plan, &err), SHEAR_OK);
    if (shear_measure_range(plan, ws, stamps, 0, stamps->count, rows, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    shear_workspace_free(ws);
}
