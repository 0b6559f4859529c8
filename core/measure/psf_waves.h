/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/psf_waves.h: exp(-i k r) on the samples of a PSF, for transforms of images with any step
 * between their samples. */
#pragma once

#include "base/arena.h"
#include "measure/mode_plane.h"
#include "shear/psf.h"

/* Immutable once filled. r is counted from the middle of the image. */
typedef struct psf_waves {
    int nx, ny;          /* samples */
    double *x_re, *x_im; /* [2 max_jx + 1][nx] */
    double *y_re, *y_im; /* [stride][ny] */
} psf_waves;

void psf_waves_place(psf_waves *w, const mode_plane *p, int nx, int ny, arena *a);
/* Fill the tables for a model's samples along x and y, with the transforms of its kernels. */
void psf_waves_fill(psf_waves *w, const mode_plane *p, const shear_psf_model *m);

/* Transform samples[ny][nx] along y, for the rows of one group: rows[FFT_LANES][re, im][nx]. */
void psf_waves_along_y(const psf_waves *w, const double *samples, int group, double *rows);
/* Transform these rows along x, for column jx: out[re, im][FFT_LANES]. */
void psf_waves_along_x(const psf_waves *w, const mode_plane *p, const double *rows, int jx,
                       double *out);
