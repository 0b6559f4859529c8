/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench/stages.h: what the parts of a measurement take, each by itself, in a loop over the stamps
 * of a case. */
#ifndef BENCH_STAGES_H
#define BENCH_STAGES_H

#include "cases.h"

enum stage {
    STAGE_PSF,         /* the stamp's own PSF to its transfer */
    STAGE_INTERPOLATE, /* logarithms, slopes, fine strips */
    STAGE_ALONG_Y,     /* transforms of strips */
    STAGE_PACK, /* filter, photometry, transposing of blocks: the rest of what comes before the next
                 */
    STAGE_ALONG_X, /* transforms of rows */
    STAGE_MOMENTS,
    STAGE_REST, /* border, flags, error terms: the rest of the whole */
    N_STAGES
};
extern const char *const stage_names[N_STAGES];

/* Microseconds per pair: one round; the whole is that of shear_measure_range in the same round. */
void stages_time(const bench_data *d, shear_workspace *ws, int repeats, double us[N_STAGES]);

#endif
