/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/plan_impl.h: what a plan and a workspace hold, for the files that execute them. */
#ifndef SHEAR_PLAN_IMPL_H
#define SHEAR_PLAN_IMPL_H

#include "fft/fft.h"
#include "measure/filter.h"
#include "measure/image.h"
#include "measure/moments.h"
#include "measure/plateau.h"
#include "measure/transfer.h"
#include "shear/plan.h"

struct shear_plan {
    shear_settings settings;
    shear_plan_info info;
    image_grid grid;           /* stamps to the fine grid */
    size_t stride;             /* of a fine row of the packed pair */
    fft_batch *rows, *columns; /* the packed pair's */
    fft_batch *mirrored;       /* columns counted from right to left */
    transfer_plan transfer_plan;
    bool has_psf; /* `transfer` serves all stamps */
    transfer transfer;
    bool filtered;           /* info.filter is not NONE */
    filter_map fine, coarse; /* the filter on both grids, unless it differs from stamp to stamp */
    plateau plateau;         /* where shot_noise is PLATEAU */
    moments flat;            /* what `transfer` makes of it */
};

struct shear_workspace {
    image galaxy, noise;
    double *galaxy_row, *noise_row; /* one fine row each */
    double *no_noise;               /* one of zeros, where noise is not corrected for */
    double complex *lines;          /* [FFT_LINES][fine_nx] of galaxy + i noise */
    double complex *pair;         /* [fine_ny, padded][stride]: transformed along x; zero but for */
    int first_row, end_row;       /* these rows */
    double complex *left, *right; /* [fine_ny][FFT_LINES]: transformed along y, too */
    filter_map fine, coarse;      /* where the filter differs from stamp to stamp */
    transfer_scratch scratch;     /* where each stamp has its own PSF */
    transfer transfer;
    const double
        *transfer_of; /* the PSF image `transfer` was made from in this batch; NULL: none */
};

/* The packed pair of stamp i on the fine grid, filtered, transformed along x into ws->pair. False
 * where a log method meets a negative pixel: (x, y), in the noise stamp if in_noise. */
typedef struct pack_failure {
    int x, y;
    bool in_noise;
} pack_failure;
bool pack_pair(const shear_plan *plan, shear_workspace *ws, const filter_map *filter,
               const double *galaxy, const double *noise, pack_failure *failure);
/* One group of its columns transformed along y, and their mirror images; until the next call. */
mode_columns transform_columns(const shear_plan *plan, shear_workspace *ws, int group);

/* The filter and the transfer of stamp i; NULL filter: none. Flags in *flags where they cannot be
 * had. */
void choose_filter(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                   const filter_map **fine, const filter_map **coarse, uint32_t *flags);
const transfer *choose_transfer(const shear_plan *plan, shear_workspace *ws,
                                const shear_stamps *stamps, int i, uint32_t *flags);

#endif
