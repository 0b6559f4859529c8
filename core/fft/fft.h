/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fft/fft.h: complex transforms of eight lines at once, and the memory they want.
 *
 * Line l is lane l of every vector, real and imaginary parts lie apart: element e is at
 * [e FFT_LANES + l]. In this shape a transform is plain arithmetic on vectors, without shuffles,
 * and takes 0.6 of FFTW's time for as many lines (docs/performance.md). Lengths of 2^a 3^b 5^c are
 * done here (pass.h); FFTW, which no other room sees, does the others. Its plans are FFTW_ESTIMATE:
 * those that are timed would be others, and round otherwise, in every process.
 *
 * Plans are immutable, and running them is thread-safe; making them is serialised inside.
 */
#ifndef SHEAR_FFT_FFT_H
#define SHEAR_FFT_FFT_H

#include <stddef.h>

/* Aligned to a cache line, which vectors of 64 bytes then never straddle. NULL: no memory. */
void *fft_alloc(size_t bytes);
double *fft_zeros(size_t n); /* n numbers */
void fft_free(void *p);

enum { FFT_LANES = 8 };

/* n, rounded up to whole groups of lanes. */
size_t fft_padded(int n);

/* The sum of a number a lane, in an order of its own: the same on every machine. */
static inline double fft_total(const double *lanes) {
    return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) +
           ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

/* Eight lines: [n][FFT_LANES] each; im lies behind re in the same memory. */
typedef struct fft_lanes {
    double *re, *im;
} fft_lanes;
fft_lanes fft_lanes_new(int n); /* zeros; re is NULL when memory is out */
void fft_lanes_free(fft_lanes lanes);

typedef struct fft_plan fft_plan;
fft_plan *fft_plan_new(int n); /* n >= 2 numbers per line; NULL when memory is out */
void fft_plan_free(fft_plan *plan);
/* What a plan takes; of lengths that FFTW does, about. */
size_t fft_plan_bytes(int n);

/* The forward transform of eight lines. Input: element e of lane l at re[e step + l], im[e step +
 * l], with step >= FFT_LANES. `a` and `b` come from fft_lanes_new, for n or more; the one that is
 * returned holds the result, the other one was scratch. `b` may be the input, which is lost then:
 * two buffers fit the first cache where three do not. Nothing else overlaps. */
fft_lanes fft_run(const fft_plan *plan, const double *re, const double *im, size_t step,
                  fft_lanes a, fft_lanes b);

/* A square block, turned: out[FFT_LANES c + r] = in[r step + c] for r, c < FFT_LANES. */
void fft_transpose(const double *in, ptrdiff_t step, double *out);

#endif
