/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/plan_impl.h: what a plan and a workspace hold, for the files that execute them. */
#ifndef SHEAR_PLAN_IMPL_H
#define SHEAR_PLAN_IMPL_H

#include "fft/fft.h"
#include "measure/filter.h"
#include "measure/image.h"
#include "measure/plateau.h"
#include "measure/transfer.h"
#include "shear/plan.h"

struct shear_plan {
    shear_settings settings;
    shear_plan_info info;
    image_grid grid;     /* stamps to the fine grid */
    size_t stride;       /* of a fine row of the packed pair */
    fft_image_plan *fft; /* the packed pair's */
    transfer_plan transfer_plan;
    bool has_psf; /* `transfer` serves all stamps */
    transfer transfer;
    bool filtered;           /* info.filter is not NONE */
    filter_map fine, coarse; /* the filter on both grids, unless it differs from stamp to stamp */
    plateau plateau;         /* where shot_noise is PLATEAU */
};

struct shear_workspace {
    image galaxy, noise;
    double *galaxy_row, *noise_row; /* one fine row each */
    double complex *pair;           /* [fine_ny][stride]: galaxy + i noise, then its transform */
    filter_map fine, coarse;        /* where the filter differs from stamp to stamp */
    transfer_scratch scratch;       /* where each stamp has its own PSF */
    transfer transfer;
    const double
        *transfer_of; /* the PSF image `transfer` was made from in this batch; NULL: none */
};

/* The packed pair of stamp i on the fine grid, filtered, rows and columns not yet transformed.
 * False where a log method meets a negative pixel: (*bad_x, *bad_y), in the noise stamp if
 * *in_noise. */
typedef struct pack_failure {
    int x, y;
    bool in_noise;
} pack_failure;
bool pack_pair(const shear_plan *plan, shear_workspace *ws, const filter_map *filter,
               const double *galaxy, const double *noise, pack_failure *failure);
/* Transform the packed pair for the columns that `t` needs: all of them for a plateau. */
void transform_pair(const shear_plan *plan, shear_workspace *ws, const filter_map *filter,
                    const transfer *t);
/* What the transformed pair's power holds of shot noise, at every mode: 0 where shot_noise is NONE.
 */
double shot_power(const shear_plan *plan, const shear_workspace *ws);

/* The filter and the transfer of stamp i; NULL filter: none. Flags in *flags where they cannot be
 * had. */
void choose_filter(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                   const filter_map **fine, const filter_map **coarse, uint32_t *flags);
const transfer *choose_transfer(const shear_plan *plan, shear_workspace *ws,
                                const shear_stamps *stamps, int i, uint32_t *flags);

#endif
