/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/sources/isophote.h: the ellipse that a source's light fills, from what its catalog has.
 *
 * SExtractor's A_IMAGE and B_IMAGE are standard deviations of the light along the axes, not the
 * isophote. They are multiplied by the larger of
 *
 *   KRON_RADIUS   the aperture of FLUX_AUTO, which holds about 94 % of a galaxy's light, and
 *   1.25 sqrt(ISOAREA_IMAGE / (pi A B))   the isophote's area and a margin,
 *
 * or by 3 if the catalog has neither. In two catalogs of DECam chips (3,240 sources with FLAGS < 4;
 * XMIN_IMAGE to YMAX_IMAGE are the isophote's extent) the isophote is inside the ellipse, to 1 px,
 * for 93 % of the sources: 87 % with KRON_RADIUS alone, 74 % with the area and no margin, 85 % with
 * 3 alone.
 *
 * Without A_IMAGE it is a circle of 2.5 FLUX_RADIUS: 2.9 standard deviations of a Gaussian, 98.7 %
 * of its light; it holds 82 % of those isophotes. Columns of other names are semi-axes as they
 * stand. */
#pragma once

#include "survey/sources/source_columns.h"

/* Return whether the table has columns for ellipses. */
bool isophote_known(const source_columns *c);

/* Read a, b and theta of the rows of c, arrays of [c->n]; NaN where a semi-axis is not positive and
 * finite. */
int isophote_read(const source_columns *c, double *a, double *b, double *theta, shear_error *err);
