/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/mesh_relation.h: how the weight map's standard deviations go with those that are
 * measured. */
#pragma once

#include "survey/cutout/noise_mesh.h"

/* Return the slope of the logarithms, measured over map, from mesh to mesh: 1 for a right map, -1
 * if variances are read as weights. NaN: there is no map, it varies by less than 5 %, or the two do
 * not go together. */
double mesh_relation_slope(const noise_mesh *m);
