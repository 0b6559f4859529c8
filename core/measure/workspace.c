/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocate and free the scratch memory of one thread. */
#include "measure/internal.h"

#include <stdlib.h>

/* Place memory for the rows of modes that any transfer of the plan may need. */
static void place_modes(shear_workspace *ws, const shear_plan *plan, arena *a) {
    const transfer widest = {.jy = plan->has_transfer ? plan->transfer.jy
                                                      : plan->transfer_plan.plane.max_jy};
    const size_t groups = (size_t)mode_groups_last(plan, &widest) + 1;
    /* One more column, so that the parts do not share cache sets. */
    ws->lane_size = ((size_t)plan->info.fine_nx + 1) * FFT_LANES;
    ws->modes = arena_doubles(a, 4 * groups * ws->lane_size);
}

/* Place what makes a transfer for each stamp. */
static void place_transfer(shear_workspace *ws, const shear_plan *plan, arena *a) {
    const mode_plane *p = &plan->transfer_plan.plane;
    if (plan->has_transfer)
        return;
    transfer_place(&ws->transfer, p, a);
    if (!plan->has_psf)
        ws->power = arena_doubles(a, p->size);
    if (plan->n_models > 0)
        psf_sky_scratch_place(&ws->psf_sky, plan->model_nx, plan->model_ny, a);
    if (!plan->has_psf && plan->n_models == 0 && plan->by_fft)
        psf_scratch_place(&ws->psf_scratch, &plan->psf_transform, a);
    if (!plan->has_psf && plan->n_models == 0 && !plan->by_fft)
        psf_direct_place(&ws->direct, p, &plan->waves, a);
}

static void place(shear_workspace *ws, const shear_plan *plan, arena *a) {
    const shear_plan_info *info = &plan->info;
    const int longest = info->fine_nx > info->fine_ny ? info->fine_nx : info->fine_ny;
    surface_place(&ws->galaxy, &plan->grid, a);
    surface_place(&ws->noise, &plan->grid, a);
    ws->strip = fft_lanes_take(a, info->fine_ny + 1);
    for (int i = 0; i < 3; i++)
        ws->lanes[i] = fft_lanes_take(a, longest + 1);
    place_modes(ws, plan, a);
    if (info->filter_per_stamp)
        filter_pair_place(&ws->filter, info->geometry.nx, info->geometry.ny, info->oversample, a);
    place_transfer(ws, plan, a);
}

int shear_workspace_new(shear_workspace **out, const shear_plan *plan, shear_error *err) {
    arena a = {0};
    *out = calloc(1, sizeof **out);
    if (*out != NULL) {
        place(*out, plan, &a);
        (*out)->memory = arena_allocate(&a);
    }
    if (*out == NULL || (*out)->memory == NULL) {
        shear_workspace_free(*out);
        *out = NULL;
        return shear_fail(err, SHEAR_E_NOMEM, NULL,
                          "out of memory for a workspace of %d x %d points", plan->info.fine_nx,
                          plan->info.fine_ny);
    }
    place(*out, plan, &a);
    return SHEAR_OK;
}

int64_t shear_workspace_bytes(const shear_plan *plan) {
    shear_workspace ws;
    arena a = {0};
    place(&ws, plan, &a);
    return (int64_t)(sizeof ws + a.used);
}

void shear_workspace_free(shear_workspace *ws) {
    if (ws != NULL) {
        free(ws->memory);
        free(ws);
    }
}
