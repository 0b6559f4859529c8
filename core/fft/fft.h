/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fft/fft.h: the only room that sees FFTW. Planning is serialised here; running a batch is
 * thread-safe.
 *
 * All transforms are batches: FFT_LINES lines at once, from one place to another, which is what
 * FFTW's vector codelets work on. One line alone takes twice as long, and a transform in place goes
 * through buffers. So shaped, FFTW_ESTIMATE finds the plans that FFTW_MEASURE does
 * (docs/performance.md), and, unlike it, the same ones in every process: results are the same to
 * the last bit. */
#ifndef SHEAR_FFT_H
#define SHEAR_FFT_H

#include <complex.h>
#include <stddef.h>

void *fft_alloc(size_t bytes); /* aligned to 64 bytes or better as FFTW wants it; NULL: no memory */
void fft_free(void *p);

enum { FFT_LINES = 8 };

/* Lines, rounded up to whole batches. */
size_t fft_padded(int lines);

/* Complex numbers in a row of nx, padded by one at least: rows start aligned, and columns do not
 * share cache sets. */
size_t fft_row_stride(int nx);

/* Where the lines of a batch are: line l, element i at [l * apart + i * step]; apart may be
 * negative for the input. */
typedef struct fft_layout {
    int step, apart;
} fft_layout;

/* Forward transforms of n complex numbers a line. Input is kept; both ends come from fft_alloc.
 * Real lines go two by two: FFTW's real codelets know no vectors, and take as long as complex ones.
 */
typedef struct fft_batch fft_batch;
fft_batch *fft_batch_new(int n, fft_layout in, fft_layout out); /* NULL when memory is out */
void fft_batch_free(fft_batch *batch);
void fft_batch_run(const fft_batch *batch, double complex *in, double complex *out);

#endif
