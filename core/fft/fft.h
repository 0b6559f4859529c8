/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fft/fft.h: complex transforms of eight lines at once.
 *
 * Line l is lane l of every vector; real and imaginary parts are separate: element e is at [e
 * FFT_LANES + l]. In this layout a transform is plain vector arithmetic without shuffles, and takes
 * 0.6 of FFTW's time for as many lines (docs/performance.md). Lengths of 2^a 3^b 5^c are
 * transformed here (pass.h), others by FFTW. Its plans are made with FFTW_ESTIMATE: plans from
 * timing would differ, and round differently, from process to process.
 *
 * Plans are immutable, and running them is thread-safe; making them is serialised inside. */
#pragma once

#include "base/arena.h"
#include "base/simd.h"

#include <stddef.h>

enum { FFT_LANES = 8 };

/* Return n rounded up to whole groups of lanes. */
size_t fft_padded(int n);

/* Return the sum over the lanes, in a fixed order: the same on every machine. */
static inline double fft_total(const double *lanes) {
    return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) +
           ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

/* Return the largest lane. */
static SHEAR_INLINE double fft_largest(const double *lanes) {
    const double a = lanes[0] > lanes[1] ? lanes[0] : lanes[1];
    const double b = lanes[2] > lanes[3] ? lanes[2] : lanes[3];
    const double c = lanes[4] > lanes[5] ? lanes[4] : lanes[5];
    const double d = lanes[6] > lanes[7] ? lanes[6] : lanes[7];
    const double ab = a > b ? a : b;
    const double cd = c > d ? c : d;
    return ab > cd ? ab : cd;
}

/* Eight lines: [n][FFT_LANES] each. im follows re without a gap. */
typedef struct fft_lanes {
    double *re, *im;
} fft_lanes;
fft_lanes fft_lanes_take(arena *a, int n);
/* Repeat element 0 as element n, where element -0 is read. */
void fft_lanes_close(fft_lanes lanes, int n);

typedef struct fft_plan fft_plan;
fft_plan *fft_plan_new(int n); /* n >= 2 elements per line; NULL if out of memory */
void fft_plan_free(fft_plan *plan);
/* Return the bytes of a plan; approximate for lengths that FFTW transforms. */
size_t fft_plan_bytes(int n);

/* Compute the forward transform of eight lines. Input: element e of lane l at re[e step + l], im[e
 * step + l], with step >= FFT_LANES. `a` and `b` come from fft_lanes_take, for n or more elements;
 * one of them is returned and holds the result, the other one was scratch. `b` may be the input,
 * which is then overwritten: two buffers fit into the first-level cache where three do not. Nothing
 * else may overlap. */
fft_lanes fft_run(const fft_plan *plan, const double *re, const double *im, size_t step,
                  fft_lanes a, fft_lanes b);

/* Transpose a square block: out[FFT_LANES c + r] = in[r step + c] for r, c < FFT_LANES. */
void fft_transpose(const double *in, ptrdiff_t step, double *out);
