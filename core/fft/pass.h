/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fft/pass.h: one pass of Stockham's autosort transform, for FFT_LANES lines at once.
 *
 * A transform of n = r m s points, of which passes with radices that multiply to s are done, takes
 *     y[q + s (r p + k)] = w(p k / (r m)) sum_j w(j k / r) x[q + s (p + m j)],
 *     w(a) = exp(-2 pi i a),    p < m, q < s, j, k < r
 * and leaves the result in order, without any bit reversal. Each line is a lane of the vectors:
 * butterflies need no shuffles, and plain C vectorises.
 */
#ifndef SHEAR_FFT_PASS_H
#define SHEAR_FFT_PASS_H

#include <stddef.h>

typedef struct fft_pass {
    int radix, m, s;
    const double *twiddle; /* [m][radix - 1] (cos, sin) of w(p k / (r m)), k from 1 */
} fft_pass;

/* The radix with which to begin a transform of n points; 1 where none of ours divides n. */
int fft_pass_radix(int n);

/* Element e of lane l: re[e step + l], im[e step + l]; step >= FFT_LANES, and = FFT_LANES where s >
 * 1. The output has step FFT_LANES, and is not the input. */
void fft_pass_run(const fft_pass *pass, const double *re, const double *im, size_t step,
                  double *out_re, double *out_im);

#endif
