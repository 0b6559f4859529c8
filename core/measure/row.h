/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/row.h: what a row says of a stamp, from its pixels and spectra. */
#ifndef SHEAR_MEASURE_ROW_H
#define SHEAR_MEASURE_ROW_H

#include "measure/photometry.h"
#include "measure/spectra.h"

/* Nothing is known yet. */
void row_init(shear_row *row, int64_t stamp, double weight, uint32_t flags);
/* Flux, signal to noise and the border's excess over the noise stamp. */
void row_fill_photometry(shear_row *row, const shear_stamps *st, const double *galaxy,
                         const double *noise, const photometry *ph);
/* The terms of the cross spectrum, for the symmetry. */
void row_fill_cross(shear_row *row, const moments *m, double beta, double r_psf);
/* The noise's own moments, and the power that galaxy and noise stamp have at high k. */
void row_fill_noise(shear_row *row, const spectra *sp, const shear_plan *plan);
/* docs/method.md, steps 5 and 6, after the others: a row that no sum could hold is flagged. */
void row_fill_moments(shear_row *row, const moments *m, double beta);

#endif
