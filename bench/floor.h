/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench/floor.h: the time F(M) of two plain FFTW r2c transforms (double, FFTW_MEASURE, one thread)
 * of the fine nx x ny grid, for the galaxy and the noise: a lower bound for any implementation. */
#pragma once

typedef struct floor_transform floor_transform;
floor_transform *floor_new(int nx, int ny); /* NULL if out of memory */
void floor_free(floor_transform *f);
void floor_run(floor_transform *f); /* do both transforms once */
/* Transform these images, which are aligned to 64 bytes. */
void floor_run_on(floor_transform *f, double *galaxy, double *noise);
