/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/internal.h: what a plan and a workspace hold, for the files that execute them. */
#ifndef SHEAR_MEASURE_INTERNAL_H
#define SHEAR_MEASURE_INTERNAL_H

#include "fft/fft.h"
#include "measure/filter.h"
#include "measure/high_power.h"
#include "measure/moments.h"
#include "measure/photometry.h"
#include "measure/plateau.h"
#include "measure/sharpness.h"
#include "measure/surface.h"
#include "measure/transfer.h"
#include "shear/plan.h"

struct shear_plan {
    shear_settings settings;
    shear_plan_info info;
    surface_grid grid;           /* stamps to the fine grid */
    fft_plan *along_x, *along_y; /* fine_nx, fine_ny */
    transfer_plan transfer_plan;
    bool has_psf; /* `transfer` serves all stamps */
    transfer transfer;
    bool filtered;           /* info.filter is not NONE */
    filter_map fine, coarse; /* the filter on both grids, unless it differs from stamp to stamp;
                                coarse only where it is another grid */
    high_band high;          /* where the noise level is read off */
    plateau plateau;         /* where shot_noise is PLATEAU */
    moments flat;            /* what `transfer` makes of it */
    sharpness sharpness;     /* of the one PSF, where there is one */
};

/* The settings of the request, or the defaults. */
shear_settings plan_settings(const shear_plan_request *request);
/* Fill *info; *psf_factor: how much finer the PSF's samples are made. `set`: plan_settings. */
int plan_resolve(shear_plan_info *info, const shear_settings *set,
                 const shear_plan_request *request, int *psf_factor, shear_error *err);

struct shear_workspace {
    surface galaxy, noise;
    fft_lanes strip;              /* [fine_ny + 1][FFT_LANES] galaxy + i noise, some columns */
    fft_lanes lanes[3];           /* [longer side + 1][FFT_LANES] for transforms */
    double level, noise_level;    /* taken off the pair before the filter; 0: nothing */
    double *modes;                /* the pair, transformed along y: see pack.c */
    size_t lane_size;             /* of its parts */
    filter_map fine, coarse;      /* where the filter differs from stamp to stamp */
    transfer_scratch psf_scratch; /* where each stamp has its own PSF */
    transfer transfer;
    double
        strip_most[SHEAR_MAX_SIDE / FFT_LANES]; /* brightest pixels of the galaxy stamp's strips */
    sharpness sharpness;                        /* where each stamp has its own PSF: ... */
    const double *sharpness_of;                 /* ... of this one, as below */
    const double
        *transfer_of; /* the PSF image `transfer` was made from in this batch; NULL: none */
};

/* The packed pair of one stamp on the fine grid, filtered, transformed along y into ws->modes for
 * the groups of rows of modes that a measurement with `t` wants; and what its pixels tell (always).
 * False where a log method meets a negative pixel: (x, y), in the noise stamp if in_noise. Where a
 * background is taken off, the galaxy stamp loses the noise stamp's mean, and that its own level
 * (photometry_level); with `own_levels` (of two noise stamps) so does the other.
 */
typedef struct pack_failure {
    int x, y;
    bool in_noise;
} pack_failure;
bool pack_pair(const shear_plan *plan, shear_workspace *ws, const filter_map *filter,
               const double *galaxy, const double *noise, bool own_levels, const transfer *t,
               photometry *ph, pack_failure *failure);
/* One of these groups transformed along x, too; until the next call. */
mode_rows pack_transform_rows(const shear_plan *plan, shear_workspace *ws, int group);
/* The last group that a measurement with `t` needs: for a plateau or the noise level, all of them.
 */
int mode_groups_last(const shear_plan *plan, const transfer *t);
bool mode_groups_want(const shear_plan *plan, const transfer *t, int group);

/* Both maps, empty; coarse only where it is another grid. False when memory is out. */
bool plan_init_filters(filter_map *fine, filter_map *coarse, const shear_plan_info *info);
/* Noise stamps per galaxy. */
static inline int noise_planes(const shear_stamps *stamps) {
    return stamps->noise_planes > 1 ? stamps->noise_planes : 1;
}

/* The filter and the transfer of stamp i; NULL filter: none. Flags in *flags where they cannot be
 * had. */
void measure_choose_filter(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                           int i, const filter_map **fine, const filter_map **coarse,
                           uint32_t *flags);
const transfer *measure_choose_transfer(const shear_plan *plan, shear_workspace *ws,
                                        const shear_stamps *stamps, int i, uint32_t *flags);

#endif
