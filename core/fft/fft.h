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

/* Forward transforms of n numbers a line. The real one gives n/2+1 modes. Input is kept; both ends
 * come from fft_alloc or lie a multiple of 16 bytes behind its start. */
typedef struct fft_batch fft_batch;
fft_batch *fft_complex_new(int n, fft_layout in, fft_layout out); /* NULL when memory is out */
fft_batch *fft_real_new(int n, fft_layout in, fft_layout out);
void fft_batch_free(fft_batch *batch);
void fft_complex(const fft_batch *batch, double complex *in, double complex *out);
void fft_real(const fft_batch *batch, double *in, double complex *out);

#endif
