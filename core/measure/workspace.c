/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocate and free the scratch memory of one thread. */
#include "measure/internal.h"

#include <stdlib.h>

/* Allocate memory for the rows of modes that any transfer of the plan may need. */
static bool modes_init(shear_workspace *ws, const shear_plan *plan) {
    const transfer widest = {.jy = plan->has_psf ? plan->transfer.jy : plan->transfer_plan.max_jy};
    const size_t groups = (size_t)mode_groups_last(plan, &widest) + 1;
    /* One more column, so that the parts do not share cache sets. */
    ws->lane_size = ((size_t)plan->info.fine_nx + 1) * FFT_LANES;
    ws->modes = fft_alloc(4 * groups * ws->lane_size * sizeof *ws->modes);
    return ws->modes != NULL;
}

static bool allocate(shear_workspace *ws, const shear_plan *plan) {
    const shear_plan_info *info = &plan->info;
    const int longest = info->fine_nx > info->fine_ny ? info->fine_nx : info->fine_ny;
    bool ok = surface_init(&ws->galaxy, &plan->grid);
    ok = surface_init(&ws->noise, &plan->grid) && ok;
    ws->strip = fft_lanes_new(info->fine_ny + 1);
    ok = ok && ws->strip.re != NULL;
    for (int i = 0; i < 3; i++) {
        ws->lanes[i] = fft_lanes_new(longest + 1);
        ok = ok && ws->lanes[i].re != NULL;
    }
    ok = modes_init(ws, plan) && ok;
    if (info->filter_per_stamp)
        ok = plan_init_filters(&ws->fine, &ws->coarse, info) && ok;
    if (!plan->has_psf) {
        ok = transfer_scratch_init(&ws->psf_scratch, &plan->transfer_plan) && ok;
        ok = transfer_init(&ws->transfer, &plan->transfer_plan) && ok;
    }
    return ok;
}

int shear_workspace_new(shear_workspace **out, const shear_plan *plan, shear_error *err) {
    *out = calloc(1, sizeof **out);
    if (*out == NULL || !allocate(*out, plan)) {
        shear_workspace_free(*out);
        *out = NULL;
        return shear_fail(err, SHEAR_E_NOMEM, NULL,
                          "out of memory for a workspace of %d x %d points", plan->info.fine_nx,
                          plan->info.fine_ny);
    }
    return SHEAR_OK;
}

void shear_workspace_free(shear_workspace *ws) {
    if (ws == NULL)
        return;
    surface_deinit(&ws->galaxy);
    surface_deinit(&ws->noise);
    fft_lanes_free(ws->strip);
    for (int i = 0; i < 3; i++)
        fft_lanes_free(ws->lanes[i]);
    fft_free(ws->modes);
    filter_map_deinit(&ws->fine);
    filter_map_deinit(&ws->coarse);
    transfer_scratch_deinit(&ws->psf_scratch);
    transfer_deinit(&ws->transfer);
    free(ws);
}
