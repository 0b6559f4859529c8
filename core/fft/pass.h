/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fft/pass.h: one pass of Stockham's autosort transform, for FFT_LANES lines at once.
 *
 * A pass of a transform of n = r m s points, after passes whose radices multiply to s, computes
 *
 *     y[q + s (r p + k)] = w(p k / (r m)) sum_j w(j k / r) x[q + s (p + m j)],
 *     w(a) = exp(-2 pi i a),    p < m, q < s, j, k < r
 *
 * and leaves the result in natural order, without bit reversal. Each line is a lane of the vectors,
 * so butterflies need no shuffles and plain C vectorises. */
#pragma once

#include <stddef.h>

typedef struct fft_pass {
    int radix, m, s;
    const double *twiddle; /* [m][radix - 1] (cos, sin) of w(p k / (r m)), k from 1 */
} fft_pass;

/* Return the radix of the first pass of a transform of n points; 1 if no radix divides n. */
int fft_pass_radix(int n);

/* Run a pass. Element e of lane l is re[e step + l], im[e step + l]; step >= FFT_LANES, and step =
 * FFT_LANES if s > 1. The output has step FFT_LANES and must not overlap the input. */
void fft_pass_run(const fft_pass *pass, const double *re, const double *im, size_t step,
                  double *out_re, double *out_im);
