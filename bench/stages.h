/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench/stages.h: times of the stages of a measurement, each in a loop over the stamps of a case.
 */
#pragma once

#include "cases.h"

enum stage {
    STAGE_PSF,         /* from the stamp's own PSF to its transfer */
    STAGE_INTERPOLATE, /* logarithms, slopes, fine strips */
    STAGE_ALONG_Y,     /* transforms of strips */
    STAGE_PACK,    /* filter, photometry, transposition of blocks: the rest before the next stage */
    STAGE_ALONG_X, /* transforms of rows */
    STAGE_MOMENTS,
    STAGE_REST, /* border, flags, error terms: the rest of the total */
    N_STAGES
};
extern const char *const stage_names[N_STAGES];

/* Time all stages once, in microseconds per pair. The total is that of shear_measure_range in the
 * same round. */
void stages_time(const bench_data *d, shear_workspace *ws, int repeats, double us[N_STAGES]);
