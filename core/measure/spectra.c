/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/spectra.h"

#include <assert.h>

static void add_rows(const shear_plan *plan, const transfer *t, const mode_rows *rows, spectra *s) {
    const mode_plane *p = &plan->transfer_plan.plane;
    if (rows->group * FFT_LANES <= t->jy) {
        moments_add(&s->difference, plan->settings.noise_correction ? &s->noise : NULL, rows, p, t);
        if (plan->settings.estimator == SHEAR_ESTIMATOR_PDF_SYM_CROSS)
            moments_add_cross(&s->cross, rows, p, t);
    }
    if (high_band_wants(&plan->high, rows->group))
        high_power_add(&s->high, &plan->high, rows);
    if (plan->settings.shot_noise == SHEAR_SHOT_PLATEAU)
        plateau_add(&plan->plateau, rows, &s->shot, &s->noise_shot);
}

spectra spectra_of(const shear_plan *plan, shear_workspace *ws, const transfer *t) {
    spectra s = {0};
    for (int group = 0; group <= mode_groups_last(plan, t); group++) {
        if (!mode_groups_want(plan, t, group))
            continue;
        const mode_rows rows = pack_transform_rows(plan, ws, group);
        if (group == 0) { /* Z(0) = sum of galaxy + i sum of noise */
            s.flux = rows.up.re[0] - rows.up.im[0];
        }
        add_rows(plan, t, &rows, &s);
    }
    return s;
}

void spectra_add_noise(spectra *all, const spectra *pair, double share) {
    moments_join(&all->noise, share, &pair->difference);
    moments_join(&all->noise, 2.0 * share, &pair->noise);
    all->noise_shot += share * (pair->shot + 2.0 * pair->noise_shot);
    all->high.edge_noise += share * (pair->high.edge_galaxy + pair->high.edge_noise);
    all->high.corner_noise += share * (pair->high.corner_galaxy + pair->high.corner_noise);
}

void spectra_set_noise(spectra *s, const spectra *all, int n) {
    assert(n > 1);
    moments mean = {0};
    moments_join(&mean, 1.0 / n, &all->noise);
    moments_join(&s->difference, 1.0, &s->noise);
    moments_join(&s->difference, -1.0, &mean);
    s->noise = mean;
    s->shot += s->noise_shot - all->noise_shot / n;
    s->high.edge_noise = all->high.edge_noise / n;
    s->high.corner_noise = all->high.corner_noise / n;
}

void spectra_forget_noise(spectra *s) {
    s->noise = (moments){0};
    s->high.edge_noise = s->high.corner_noise = 0.0;
}

void spectra_subtract_plateau(spectra *s, const shear_plan *plan, const transfer *t) {
    if (plan->settings.shot_noise == SHEAR_SHOT_PLATEAU) {
        const moments flat =
            plan->has_transfer ? plan->flat : moments_of_flat(&plan->transfer_plan.plane, t);
        moments_join(&s->difference, -s->shot, &flat);
    }
}
