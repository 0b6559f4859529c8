/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which groups of FFT_LANES rows of modes a measurement needs. */
#include "measure/internal.h"

int mode_groups_last(const shear_plan *plan, const transfer *t) {
    if (plan->settings.shot_noise == SHEAR_SHOT_PLATEAU)
        return plan->plateau.last_group;
    const int last = t->jy / FFT_LANES;
    return high_band_is_set(&plan->high) && plan->high.last_group > last ? plan->high.last_group
                                                                         : last;
}

bool mode_groups_want(const shear_plan *plan, const transfer *t, int group) {
    return plan->settings.shot_noise == SHEAR_SHOT_PLATEAU || group * FFT_LANES <= t->jy ||
           high_band_wants(&plan->high, group);
}
