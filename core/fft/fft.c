/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fft/fft.h"

#include "base/simd.h"
#include "base/thread.h"
#include "fft/pass.h"

#include <assert.h>
#include <fftw3.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { CACHE_LINE = 64, MAX_PASSES = 32 };

/* FFTW's planner has global state: only fftw_execute* may run concurrently with it. */
static pthread_mutex_t planner = PTHREAD_MUTEX_INITIALIZER;

struct fft_plan {
    int n;
    int n_passes;
    fft_pass pass[MAX_PASSES];
    double *twiddles;
    fftw_plan other; /* if n has other factors: from lanes to lanes */
};

/* Allocate memory aligned to a cache line, so that no vector of 64 bytes straddles two. */
static void *allocate(size_t bytes) {
    return aligned_alloc(CACHE_LINE, (bytes / CACHE_LINE + 1) * CACHE_LINE);
}

fft_lanes fft_lanes_take(arena *a, int n) {
    const size_t half = (size_t)n * FFT_LANES;
    double *memory = arena_doubles(a, 2 * half);
    return (fft_lanes){.re = memory, .im = memory != NULL ? memory + half : NULL};
}

void fft_lanes_close(fft_lanes lanes, int n) {
    const size_t end = (size_t)n * FFT_LANES;
    memcpy(lanes.re + end, lanes.re, FFT_LANES * sizeof *lanes.re);
    memcpy(lanes.im + end, lanes.im, FFT_LANES * sizeof *lanes.im);
}

size_t fft_padded(int n) {
    return ((size_t)n + FFT_LANES - 1) / FFT_LANES * FFT_LANES;
}

/* Split n into passes. Return false if n has other factors. The twiddles take at most n numbers
 * (cos, sin) per pass. */
static bool find_passes(fft_plan *plan) {
    int left = plan->n;
    int done = 1;
    while (left > 1) {
        const int radix = fft_pass_radix(left);
        if (radix == 1)
            return false;
        left /= radix;
        plan->pass[plan->n_passes++] = (fft_pass){.radix = radix, .m = left, .s = done};
        done *= radix;
    }
    return true;
}

static bool make_twiddles(fft_plan *plan) {
    plan->twiddles = allocate((size_t)plan->n_passes * 2 * (size_t)plan->n * sizeof(double));
    double *w = plan->twiddles;
    for (int i = 0; w != NULL && i < plan->n_passes; i++) {
        fft_pass *pass = &plan->pass[i];
        pass->twiddle = w;
        for (int p = 0; p < pass->m; p++) {
            for (int k = 1; k < pass->radix; k++) {
                const double angle = -2.0 * M_PI * p * k / ((double)pass->radix * pass->m);
                *w++ = cos(angle);
                *w++ = sin(angle);
            }
        }
    }
    return plan->twiddles != NULL;
}

/* Make a plan of FFTW for interleaved complex numbers: its vector codelets need them, and split
 * ones take several times as long. */
static bool make_other(fft_plan *plan) {
    const size_t points = (size_t)plan->n * FFT_LANES;
    CLEANUP(release_free) fftw_complex *in = allocate(2 * points * sizeof *in);
    if (in == NULL)
        return false;
    LOCKED(&planner);
    plan->other = fftw_plan_many_dft(1, &plan->n, FFT_LANES, in, NULL, FFT_LANES, 1, in + points,
                                     NULL, FFT_LANES, 1, FFTW_FORWARD, FFTW_ESTIMATE);
    return plan->other != NULL;
}

size_t fft_plan_bytes(int n) {
    fft_plan plan = {.n = n};
    const int passes = find_passes(&plan) ? plan.n_passes : 1;
    return sizeof plan + (size_t)passes * 2 * (size_t)n * sizeof(double);
}

fft_plan *fft_plan_new(int n) {
    fft_plan *plan = calloc(1, sizeof *plan);
    if (plan == NULL)
        return NULL;
    plan->n = n;
    const bool made = find_passes(plan) ? make_twiddles(plan) : make_other(plan);
    if (!made) {
        fft_plan_free(plan);
        return NULL;
    }
    return plan;
}

void fft_plan_free(fft_plan *plan) {
    if (plan == NULL)
        return;
    if (plan->other != NULL) {
        LOCKED(&planner);
        fftw_destroy_plan(plan->other);
    }
    free(plan->twiddles);
    free(plan);
}

SHEAR_SIMD static void join(int n, const double *restrict re, const double *restrict im,
                            size_t step, double *restrict out) {
    for (size_t e = 0; e < (size_t)n; e++) {
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++) {
            out[2 * (e * FFT_LANES + l)] = re[e * step + l];
            out[2 * (e * FFT_LANES + l) + 1] = im[e * step + l];
        }
    }
}

SHEAR_SIMD static void part(int n, const double *restrict in, fft_lanes out) {
#pragma omp simd
    for (size_t i = 0; i < (size_t)n * FFT_LANES; i++) {
        out.re[i] = in[2 * i];
        out.im[i] = in[2 * i + 1];
    }
}

fft_lanes fft_run(const fft_plan *plan, const double *re, const double *im, size_t step,
                  fft_lanes a, fft_lanes b) {
    assert(step >= FFT_LANES && a.re != b.re);
    if (plan->other != NULL) {
        join(plan->n, re, im, step, a.re);
        fftw_execute_dft(plan->other, (fftw_complex *)a.re, (fftw_complex *)b.re);
        part(plan->n, b.re, a);
        return a;
    }
    for (int i = 0; i < plan->n_passes; i++) {
        const fft_lanes to = i % 2 == 0 ? a : b;
        fft_pass_run(&plan->pass[i], re, im, step, to.re, to.im);
        re = to.re;
        im = to.im;
        step = FFT_LANES;
    }
    return plan->n_passes % 2 == 1 ? a : b;
}

SHEAR_SIMD void fft_transpose(const double *restrict in, ptrdiff_t step, double *restrict out) {
    for (int c = 0; c < FFT_LANES; c++) {
        for (int r = 0; r < FFT_LANES; r++)
            out[FFT_LANES * c + r] = in[r * step + c];
    }
}
