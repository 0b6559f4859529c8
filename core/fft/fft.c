/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fft/fft.h"

#include <fftw3.h>
#include <pthread.h>
#include <stdlib.h>

/* FFTW's planner keeps global state: only fftw_execute* may run beside it. */
static pthread_mutex_t planner = PTHREAD_MUTEX_INITIALIZER;

struct fft_image_plan {
    fftw_plan row;     /* one row, in place */
    fftw_plan columns; /* FFT_COLUMNS adjacent columns, in place */
};

struct fft_line_plan {
    fftw_plan plan;
};

void *fft_alloc(size_t bytes) {
    return fftw_malloc(bytes > 0 ? bytes : 1);
}

void fft_free(void *p) {
    fftw_free(p);
}

size_t fft_row_stride(int nx) {
    /* A multiple of a group, and an odd number of groups: a stride that is a power of two would map
     * a column onto a few cache sets. */
    const size_t groups = ((size_t)nx + FFT_COLUMNS - 1) / FFT_COLUMNS;
    return FFT_COLUMNS * (groups | 1u);
}

static void destroy(fftw_plan plan) {
    if (plan != NULL) {
        pthread_mutex_lock(&planner);
        fftw_destroy_plan(plan);
        pthread_mutex_unlock(&planner);
    }
}

fft_image_plan *fft_image_new(int nx, int ny) {
    const size_t stride = fft_row_stride(nx);
    fft_image_plan *plan = calloc(1, sizeof *plan);
    fftw_complex *image = fft_alloc(stride * (size_t)ny * sizeof *image);
    if (plan != NULL && image != NULL) {
        pthread_mutex_lock(&planner);
        plan->row = fftw_plan_dft_1d(nx, image, image, FFTW_FORWARD, FFTW_ESTIMATE);
        plan->columns = fftw_plan_many_dft(1, &ny, FFT_COLUMNS, image, NULL, (int)stride, 1, image,
                                           NULL, (int)stride, 1, FFTW_FORWARD, FFTW_ESTIMATE);
        pthread_mutex_unlock(&planner);
    }
    fft_free(image);
    if (plan != NULL && (plan->row == NULL || plan->columns == NULL)) {
        fft_image_free(plan);
        plan = NULL;
    }
    return plan;
}

void fft_image_free(fft_image_plan *plan) {
    if (plan != NULL) {
        destroy(plan->row);
        destroy(plan->columns);
        free(plan);
    }
}

void fft_image_row(const fft_image_plan *plan, double complex *row) {
    fftw_execute_dft(plan->row, row, row);
}

void fft_image_columns(const fft_image_plan *plan, double complex *image, int group) {
    double complex *first = image + (size_t)group * FFT_COLUMNS;
    fftw_execute_dft(plan->columns, first, first);
}

/* Wrap a plan made under the lock; NULL where either allocation failed. */
static fft_line_plan *line_plan(fftw_plan made) {
    fft_line_plan *plan = made != NULL ? malloc(sizeof *plan) : NULL;
    if (plan == NULL) {
        destroy(made);
        return NULL;
    }
    plan->plan = made;
    return plan;
}

fft_line_plan *fft_line_real_new(int n) {
    double *in = fft_alloc((size_t)n * sizeof *in);
    fftw_complex *out = fft_alloc(((size_t)n / 2 + 1) * sizeof *out);
    fftw_plan made = NULL;
    if (in != NULL && out != NULL) {
        pthread_mutex_lock(&planner);
        made = fftw_plan_dft_r2c_1d(n, in, out, FFTW_ESTIMATE | FFTW_PRESERVE_INPUT);
        pthread_mutex_unlock(&planner);
    }
    fft_free(in);
    fft_free(out);
    return line_plan(made);
}

fft_line_plan *fft_line_complex_new(int n) {
    fftw_complex *line = fft_alloc((size_t)n * sizeof *line);
    fftw_plan made = NULL;
    if (line != NULL) {
        pthread_mutex_lock(&planner);
        made = fftw_plan_dft_1d(n, line, line, FFTW_FORWARD, FFTW_ESTIMATE);
        pthread_mutex_unlock(&planner);
    }
    fft_free(line);
    return line_plan(made);
}

void fft_line_free(fft_line_plan *plan) {
    if (plan != NULL) {
        destroy(plan->plan);
        free(plan);
    }
}

void fft_line_real(const fft_line_plan *plan, double *in, double complex *out) {
    fftw_execute_dft_r2c(plan->plan, in, out);
}

void fft_line_complex(const fft_line_plan *plan, double complex *line) {
    fftw_execute_dft(plan->plan, line, line);
}
