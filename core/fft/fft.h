/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fft/fft.h: the only room that sees FFTW. Plans are immutable, executing them is thread-safe,
 * making them is serialised inside. All are FFTW_ESTIMATE: timing-based planning would give other
 * rounding in every process.
 *
 * Complex arrays are interleaved (re, im), as in FFTW and C99. Memory comes from fft_alloc (aligned
 * for SIMD).
 */
#ifndef SHEAR_FFT_H
#define SHEAR_FFT_H

#include <complex.h>
#include <stddef.h>

void *fft_alloc(size_t bytes); /* NULL when memory is out */
void fft_free(void *p);

/* Complex numbers in a row of nx, padded: every row starts aligned, and rows do not share cache
 * sets. */
size_t fft_row_stride(int nx);

/* The forward transform of a complex nx x ny image with rows of fft_row_stride(nx), in place, in
 * two passes, each row and each group of columns by itself, so that a caller transforms only what
 * it needs. */
enum { FFT_COLUMNS = 8 }; /* columns in a group */
typedef struct fft_image_plan fft_image_plan;
fft_image_plan *fft_image_new(int nx, int ny); /* NULL when memory is out */
void fft_image_free(fft_image_plan *plan);
void fft_image_row(const fft_image_plan *plan, double complex *row);
/* Columns [FFT_COLUMNS g, FFT_COLUMNS (g+1)) of the image, group g counted over the padded stride.
 */
void fft_image_columns(const fft_image_plan *plan, double complex *image, int group);

/* Transforms of single lines of n numbers, out of place for the real one (in is kept, out holds
 * n/2+1 modes) and in place for the complex one. Lines come from fft_alloc, or lie a multiple of
 * FFT_ALIGN bytes behind its start. */
enum { FFT_ALIGN = 64 };
typedef struct fft_line_plan fft_line_plan;
fft_line_plan *fft_line_real_new(int n); /* NULL when memory is out */
fft_line_plan *fft_line_complex_new(int n);
void fft_line_free(fft_line_plan *plan);
void fft_line_real(const fft_line_plan *plan, double *in, double complex *out);
void fft_line_complex(const fft_line_plan *plan, double complex *line);

#endif
