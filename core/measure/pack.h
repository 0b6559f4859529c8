/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/pack.h: two real rows in one complex one. */
#ifndef SHEAR_MEASURE_PACK_H
#define SHEAR_MEASURE_PACK_H

#include <complex.h>

/* out[i] = filter[i] (re[i] + i im[i]), i < n; a NULL filter is 1. */
void pack_row(double complex *out, const double *re, const double *im, const double *filter, int n);

#endif
