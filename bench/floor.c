/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "floor.h"

#include <fftw3.h>
#include <stdlib.h>

struct floor_transform {
    double *in[2];
    fftw_complex *out[2];
    fftw_plan plan;
};

floor_transform *floor_new(int nx, int ny) {
    const size_t pixels = (size_t)nx * (size_t)ny;
    floor_transform *f = calloc(1, sizeof *f);
    if (f == NULL)
        return NULL;
    for (int i = 0; i < 2; i++) {
        f->in[i] = fftw_malloc(pixels * sizeof(double));
        f->out[i] = fftw_malloc((size_t)ny * ((size_t)nx / 2 + 1) * sizeof(fftw_complex));
        if (f->in[i] == NULL || f->out[i] == NULL) {
            floor_free(f);
            return NULL;
        }
    }
    f->plan = fftw_plan_dft_r2c_2d(ny, nx, f->in[0], f->out[0], FFTW_MEASURE);
    for (size_t i = 0; i < pixels; i++)
        f->in[0][i] = f->in[1][i] = (double)(i % 17) - 8.0;
    return f;
}

void floor_free(floor_transform *f) {
    if (f == NULL)
        return;
    for (int i = 0; i < 2; i++) {
        fftw_free(f->in[i]);
        fftw_free(f->out[i]);
    }
    if (f->plan != NULL)
        fftw_destroy_plan(f->plan);
    free(f);
}

void floor_run_on(floor_transform *f, double *galaxy, double *noise) {
    fftw_execute_dft_r2c(f->plan, galaxy, f->out[0]);
    fftw_execute_dft_r2c(f->plan, noise, f->out[1]);
}

void floor_run(floor_transform *f) {
    floor_run_on(f, f->in[0], f->in[1]);
}
