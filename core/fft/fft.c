/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fft/fft.h"

#include <fftw3.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>

/* FFTW's planner keeps global state: only fftw_execute* may run beside it. */
static pthread_mutex_t planner = PTHREAD_MUTEX_INITIALIZER;

struct fft_batch {
    fftw_plan plan;
};

void *fft_alloc(size_t bytes) {
    return fftw_malloc(bytes > 0 ? bytes : 1);
}

void fft_free(void *p) {
    fftw_free(p);
}

size_t fft_padded(int lines) {
    return ((size_t)lines + FFT_LINES - 1) / FFT_LINES * FFT_LINES;
}

size_t fft_row_stride(int nx) {
    /* An odd number of cache lines' groups: a stride that is a power of two would map a column onto
     * a few cache sets. */
    const size_t groups = fft_padded(nx + 1) / FFT_LINES;
    return FFT_LINES * (groups | 1u);
}

/* Numbers that a batch's lines span, and how many of them lie before the first one. */
static size_t span(int n, fft_layout layout) {
    return (size_t)(n - 1) * (size_t)layout.step + (FFT_LINES - 1) * (size_t)abs(layout.apart) + 1;
}

static size_t before(fft_layout layout) {
    return layout.apart < 0 ? (FFT_LINES - 1) * (size_t)-layout.apart : 0;
}

static fft_batch *make_batch(bool real, int n, fft_layout in, fft_layout out) {
    fft_batch *batch = calloc(1, sizeof *batch);
    double *memory = fft_alloc(span(n, in) * (real ? sizeof(double) : sizeof(fftw_complex)));
    fftw_complex *to = fft_alloc(span(n, out) * sizeof *to);
    if (batch != NULL && memory != NULL && to != NULL) {
        double *real_from = memory + before(in);
        fftw_complex *from = (fftw_complex *)memory + before(in);
        pthread_mutex_lock(&planner);
        batch->plan = real ? fftw_plan_many_dft_r2c(1, &n, FFT_LINES, real_from, NULL, in.step,
                                                    in.apart, to, NULL, out.step, out.apart,
                                                    FFTW_ESTIMATE | FFTW_PRESERVE_INPUT)
                           : fftw_plan_many_dft(1, &n, FFT_LINES, from, NULL, in.step, in.apart, to,
                                                NULL, out.step, out.apart, FFTW_FORWARD,
                                                FFTW_ESTIMATE | FFTW_PRESERVE_INPUT);
        pthread_mutex_unlock(&planner);
    }
    fft_free(memory);
    fft_free(to);
    if (batch != NULL && batch->plan == NULL) {
        free(batch);
        batch = NULL;
    }
    return batch;
}

fft_batch *fft_complex_new(int n, fft_layout in, fft_layout out) {
    return make_batch(false, n, in, out);
}

fft_batch *fft_real_new(int n, fft_layout in, fft_layout out) {
    return make_batch(true, n, in, out);
}

void fft_batch_free(fft_batch *batch) {
    if (batch != NULL) {
        pthread_mutex_lock(&planner);
        fftw_destroy_plan(batch->plan);
        pthread_mutex_unlock(&planner);
        free(batch);
    }
}

void fft_complex(const fft_batch *batch, double complex *in, double complex *out) {
    fftw_execute_dft(batch->plan, in, out);
}

void fft_real(const fft_batch *batch, double *in, double complex *out) {
    fftw_execute_dft_r2c(batch->plan, in, out);
}
