/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "catalog_fixture.h"

#include "fits_fixture.h"

#include <math.h>
#include <stddef.h>

enum { SIDE = 16 };

shear_plan *catalog_plan;

int catalog_setup(void **state) {
    double psf[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = i % SIDE - SIDE / 2;
        const double y = i / SIDE - SIDE / 2;
        psf[i] = exp(-(x * x + y * y) / (2 * 1.5 * 1.5));
    }
    const shear_geometry geometry = {
        .nx = SIDE, .ny = SIDE, .psf_nx = SIDE, .psf_ny = SIDE, .psf_oversample = 1};
    shear_settings settings;
    shear_error err = {0};
    shear_settings_init(&settings);
    if (shear_plan_new(
            &catalog_plan,
            &(shear_plan_request){.settings = &settings, .geometry = geometry, .psf = psf},
            &err) != SHEAR_OK) {
        print_error("%s\n", err.message);
        return -1;
    }
    return fixture_setup(state);
}

int catalog_teardown(void **state) {
    shear_plan_free(catalog_plan);
    return fixture_teardown(state);
}

shear_field_info catalog_info(int64_t n, unsigned columns) {
    shear_field_info info = {.name = "field one",
                             .pixscale = NAN,
                             .has_truth = true,
                             .sim_g1 = 0.1,
                             .sim_g2 = -0.02,
                             .n_stamps = n,
                             .n_psf = 1,
                             .columns = columns};
    info.geometry = (shear_geometry){
        .nx = SIDE, .ny = SIDE, .psf_nx = SIDE, .psf_ny = SIDE, .psf_oversample = 1};
    return info;
}

shear_row catalog_row(int64_t i) {
    shear_row row;
    double *members = (double *)&row;
    for (size_t k = 0; k < offsetof(shear_row, flags) / sizeof(double); k++) {
        members[k] = (double)i + 1.0 / (double)(k + 3); /* needs all bits of a double */
    }
    row.flags = i % 4 == 0 ? (1u << (i % SHEAR_N_FLAGS)) | SHEAR_FLAG_OVERFLOW : 0u;
    if (row.flags != 0) {
        row.d = NAN;
        row.snr = INFINITY;
    }
    return row;
}

shear_result catalog_result(int64_t n) {
    shear_result r = {.valid = true,
                      .g1 = 0.1 + 1e-17,
                      .g2 = -1.0 / 3.0,
                      .g1_err = 1e-3,
                      .g2_err = 2.0 / 7.0,
                      .cov12 = -1e-300,
                      .n_stamps = n,
                      .n_used = 8,
                      .n_flagged = 3};
    for (int i = 0; i < SHEAR_N_FLAGS; i++)
        r.flagged[i] = i + 1;
    return r;
}
