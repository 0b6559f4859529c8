/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a stamp pair to its transform: galaxy + i noise on the fine grid, filtered, one complex FFT
 * for both. */
#include "base/simd.h"
#include "measure/plan_impl.h"

#include <string.h>

SHEAR_SIMD static void pack_row(double complex *out, const double *galaxy, const double *noise,
                                const double *filter, int n) {
    double *pairs = (double *)out;
    if (filter != NULL) {
#pragma omp simd
        for (int i = 0; i < n; i++) {
            pairs[2 * i] = filter[i] * galaxy[i];
            pairs[2 * i + 1] = filter[i] * noise[i];
        }
    } else {
#pragma omp simd
        for (int i = 0; i < n; i++) {
            pairs[2 * i] = galaxy[i];
            pairs[2 * i + 1] = noise[i];
        }
    }
}

/* One fine row of the pair: interpolated where the filter lets it through, zero elsewhere. */
static void make_row(const shear_plan *plan, shear_workspace *ws, const filter_map *filter, int y) {
    const int width = plan->info.fine_nx;
    double complex *row = ws->pair + (size_t)y * plan->stride;
    const int x0 = filter != NULL ? filter->x0[y] : 0;
    const int x1 = filter != NULL ? filter->x1[y] : width;
    memset(row, 0, (size_t)x0 * sizeof *row);
    memset(row + x1, 0, (size_t)(width - x1) * sizeof *row);
    image_row(&ws->galaxy, &plan->grid, y, x0, x1, ws->galaxy_row);
    if (plan->settings.noise_correction) {
        image_row(&ws->noise, &plan->grid, y, x0, x1, ws->noise_row);
    } else {
        memset(ws->noise_row, 0, (size_t)(x1 - x0) * sizeof *ws->noise_row);
    }
    const double *values = filter != NULL ? filter->value + (size_t)y * (size_t)width + x0 : NULL;
    pack_row(row + x0, ws->galaxy_row, ws->noise_row, values, x1 - x0);
}

static bool row_is_empty(const filter_map *filter, int y) {
    return filter != NULL && filter->x1[y] == filter->x0[y];
}

bool pack_pair(const shear_plan *plan, shear_workspace *ws, const filter_map *filter,
               const double *galaxy, const double *noise, pack_failure *failure) {
    failure->in_noise = false;
    if (!image_load(&ws->galaxy, &plan->grid, galaxy, &failure->x, &failure->y)) {
        return false;
    }
    failure->in_noise = true;
    if (plan->settings.noise_correction &&
        !image_load(&ws->noise, &plan->grid, noise, &failure->x, &failure->y)) {
        return false;
    }
    for (int y = 0; y < plan->info.fine_ny; y++) {
        if (row_is_empty(filter, y)) {
            memset(ws->pair + (size_t)y * plan->stride, 0, plan->stride * sizeof *ws->pair);
        } else {
            make_row(plan, ws, filter, y);
        }
    }
    return true;
}

static bool wants_plateau(const shear_plan *plan) {
    return plan->settings.shot_noise == SHEAR_SHOT_PLATEAU;
}

double shot_power(const shear_plan *plan, const shear_workspace *ws) {
    return wants_plateau(plan) ? plateau_of(&plan->plateau, ws->pair, plan->stride) : 0.0;
}

void transform_pair(const shear_plan *plan, shear_workspace *ws, const filter_map *filter,
                    const transfer *t) {
    for (int y = 0; y < plan->info.fine_ny; y++) {
        if (!row_is_empty(filter, y)) {
            fft_image_row(plan->fft, ws->pair + (size_t)y * plan->stride);
        }
    }
    /* Only columns with |jx| <= t->jx carry information: groups from the left, then those from the
     * right. */
    const int last = (plan->info.fine_nx - 1) / FFT_COLUMNS;
    const int jx = wants_plateau(plan) ? plan->info.fine_nx / 2 : t->jx;
    const int left = jx / FFT_COLUMNS;
    const int right = (plan->info.fine_nx - jx) / FFT_COLUMNS;
    for (int group = 0; group <= left; group++) {
        fft_image_columns(plan->fft, ws->pair, group);
    }
    for (int group = right > left ? right : left + 1; group <= last; group++) {
        fft_image_columns(plan->fft, ws->pair, group);
    }
}
