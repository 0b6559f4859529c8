/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench/floor.h: the floor F(M): two plain FFTW r2c transforms (double, FFTW_MEASURE, one thread)
 * of the fine nx x ny grid, one for the galaxy and one for the noise. What anyone would compute
 * first. */
#ifndef BENCH_FLOOR_H
#define BENCH_FLOOR_H

typedef struct floor_transform floor_transform;
floor_transform *floor_new(int nx, int ny); /* NULL when memory is out */
void floor_free(floor_transform *f);
void floor_run(floor_transform *f); /* both transforms, once */
/* Of these images, aligned to 64 bytes. */
void floor_run_on(floor_transform *f, double *galaxy, double *noise);

#endif
