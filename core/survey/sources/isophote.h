/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/sources/isophote.h: the ellipse that a source's light fills, from what its catalog has.
 *
 * SExtractor's A_IMAGE and B_IMAGE are standard deviations of the light along the axes, not the
 * isophote. They are multiplied, in this order of preference, by
 *
 *   KRON_RADIUS   the aperture of FLUX_AUTO, which holds at least 94 % of a galaxy's light;
 *   sqrt(ISOAREA_IMAGE / (pi A B))   the ellipse that has the area of the isophote;
 *   3             where SExtractor's manual puts the isophote's limit.
 *
 * Without them, a circle of 2.5 FLUX_RADIUS: 2.9 standard deviations of a Gaussian, 98.7 % of its
 * light. Columns of other names are semi-axes as they stand. */
#pragma once

#include "survey/sources/source_columns.h"

/* Return whether the table has columns for ellipses. */
bool isophote_known(const source_columns *c);

/* Read a, b and theta, arrays of a number per row; NaN where a semi-axis is not positive and
 * finite. */
int isophote_read(const source_columns *c, double *a, double *b, double *theta, shear_error *err);
