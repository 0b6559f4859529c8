/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cases.h"

#include "base/cleanup.h"
#include "timer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

const bench_case bench_cases[] = {
    {"64 px, none", 64, "none", 1, 1.5, 6, false},
    {"48 px, none", 48, "none", 1, 1.5, 4, false},
    {"96 px, none", 96, "none", 1, 2.0, 8, false},
    {"256 px, none (the paper's)", 256, "none", 1, 4.0, 30, false},
    {"32 px to 256, log-bicubic", 32, "log-bicubic", 8, 0.6, 3, false},
    {"32 px to 256, log-spline", 32, "log-spline", 8, 0.6, 3, false},
    {"64 px, none, a PSF a stamp", 64, "none", 1, 1.5, 6, true},
};
const int bench_n_cases = sizeof bench_cases / sizeof bench_cases[0];

static double uniform(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return (double)(*state >> 8) / 16777216.0;
}

static void draw(double *out, int n, double sigma, double amplitude, double background,
                 uint32_t *seed) {
    const double centre = 0.5 * (n - 1);
    for (int y = 0; y < n; y++) {
        for (int x = 0; x < n; x++) {
            const double r2 = (x - centre) * (x - centre) + (y - centre) * (y - centre);
            out[y * n + x] = amplitude * exp(-0.5 * r2 / (sigma * sigma)) +
                             background * (1.0 + 0.1 * uniform(seed));
        }
    }
}

static int make_plan(bench_data *d, const bench_case *c, shear_error *err) {
    shear_settings settings;
    shear_settings_init(&settings);
    TRY(shear_settings_set(&settings, "interpolation", c->interpolation, err));
    settings.oversample = c->oversample > 1 ? c->oversample : 0;
    /* the paper's filter, at the beta that the plan will choose */
    settings.core_px = fmin(c->r_gal_px + 4.0 * 1.5 * c->r_psf_px, 0.45 * c->side);
    return shear_plan_new(&d->plan,
                          &(shear_plan_request){.settings = &settings,
                                                .geometry = {c->side, c->side, c->side, c->side, 1},
                                                .psf = c->psf_per_stamp ? NULL : d->block->psf,
                                                .r_psf_px = c->r_psf_px},
                          err);
}

int bench_data_init(bench_data *d, const bench_case *c, int count, shear_error *err) {
    const shear_field_info info = {.geometry = {c->side, c->side, c->side, c->side, 1},
                                   .psf_layout = SHEAR_PSF_PER_STAMP};
    const size_t pixels = (size_t)c->side * (size_t)c->side;
    uint32_t seed = 1;
    *d = (bench_data){.count = count, .rows = malloc((size_t)count * sizeof(shear_row))};
    if (d->rows == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %d stamps", count);
    TRY(shear_block_new(&d->block, &info, count, err));
    shear_stamps *stamps = &d->block->stamps;
    stamps->count = count;
    for (int i = 0; i < count; i++) {
        draw(d->block->galaxy + (size_t)i * pixels, c->side, hypot(c->r_gal_px / 2, c->r_psf_px),
             10.0, 1.0, &seed);
        draw(d->block->noise + (size_t)i * pixels, c->side, 1.0, 0.0, 1.0, &seed);
        d->block->psf_index[i] = i;
    }
    stamps->n_psf = c->psf_per_stamp ? count : 1;
    for (int i = 0; i < stamps->n_psf; i++)
        draw(d->block->psf + (size_t)i * pixels, c->side, c->r_psf_px, 1.0, 0.0, &seed);
    if (!c->psf_per_stamp) {
        stamps->n_psf = 0;
        stamps->psf = NULL;
        stamps->psf_index = NULL;
    }
    return make_plan(d, c, err);
}

void bench_data_deinit(bench_data *d) {
    shear_plan_free(d->plan);
    shear_block_free(d->block);
    free(d->rows);
    *d = (bench_data){0};
}

void bench_data_measure(const bench_data *d, shear_workspace *ws, int repeats, shear_row *rows) {
    shear_error err;
    for (int i = 0; i < repeats; i++) {
        if (shear_measure_range(d->plan, ws, &d->block->stamps, 0, d->count, rows, &err) !=
            SHEAR_OK) {
            fprintf(stderr, "shear-bench: %s\n", err.message);
            exit(1);
        }
    }
}

double bench_data_time_pairs(const bench_data *d, shear_workspace *ws, int repeats) {
    const double start = timer_processor_us();
    bench_data_measure(d, ws, repeats, d->rows);
    return (timer_processor_us() - start) / ((double)repeats * d->count);
}
