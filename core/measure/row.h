/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/row.h: fill a stamp's row from its pixels and spectra. */
#pragma once

#include "measure/photometry.h"
#include "measure/spectra.h"

/* Set the stamp's number, weight, frame and flags; NaN in all that is not known yet. */
void row_init(shear_row *row, int64_t stamp, double weight, enum shear_frame frame, uint32_t flags);
/* Fill in flux, signal to noise, and the border's excess over the noise stamp. */
void row_fill_photometry(shear_row *row, const shear_stamps *st, const double *galaxy,
                         const double *noise, const photometry *ph);
/* Fill in the terms of the cross spectrum, for PDF symmetrization. */
void row_fill_cross(shear_row *row, const moments *m, double beta, double r_psf);
/* Fill in the noise's own moments, and the power of the galaxy and the noise stamp at high k. */
void row_fill_noise(shear_row *row, const spectra *sp, const shear_plan *plan);
/* Fill in the error of D that a point source would have, whose stamp has noise in `area` pixels of
 * the filter. */
void row_fill_d_err(shear_row *row, const spectra *sp, const shear_plan *plan, double area);
/* Fill in the moments and the terms made of them (docs/method.md, section 4). Call it last: it
 * flags a row that no sum could hold. */
void row_fill_moments(shear_row *row, const moments *m, double beta);
