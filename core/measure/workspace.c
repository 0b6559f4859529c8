/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/plan_impl.h"

#include <stdlib.h>
#include <string.h>

static bool allocate(shear_workspace *ws, const shear_plan *plan) {
    const shear_plan_info *info = &plan->info;
    const size_t row = (size_t)info->fine_nx;
    const size_t points = plan->stride * fft_padded(info->fine_ny);
    const size_t columns = (size_t)info->fine_ny * FFT_LINES;
    bool ok = image_init(&ws->galaxy, &plan->grid);
    ok = image_init(&ws->noise, &plan->grid) && ok;
    ws->galaxy_row = fft_alloc(row * sizeof *ws->galaxy_row);
    ws->noise_row = fft_alloc(row * sizeof *ws->noise_row);
    ws->no_noise = fft_alloc(row * sizeof *ws->no_noise);
    ws->lines = fft_alloc(FFT_LINES * row * sizeof *ws->lines);
    ws->pair = fft_alloc(points * sizeof *ws->pair);
    ws->left = fft_alloc(columns * sizeof *ws->left);
    ws->right = fft_alloc(columns * sizeof *ws->right);
    ok = ok && ws->galaxy_row != NULL && ws->noise_row != NULL && ws->no_noise != NULL &&
         ws->lines != NULL && ws->pair != NULL && ws->left != NULL && ws->right != NULL;
    if (ok) { /* padding is transformed too, and must be numbers */
        memset(ws->pair, 0, points * sizeof *ws->pair);
        memset(ws->no_noise, 0, row * sizeof *ws->no_noise);
    }
    if (info->filter_per_stamp) {
        ok = filter_map_init(&ws->fine, info->geometry.nx, info->geometry.ny, info->oversample) &&
             ok;
        ok = filter_map_init(&ws->coarse, info->geometry.nx, info->geometry.ny, 1) && ok;
    }
    if (!plan->has_psf) {
        ok = transfer_scratch_init(&ws->scratch, &plan->transfer_plan) && ok;
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
    if (ws == NULL) {
        return;
    }
    image_deinit(&ws->galaxy);
    image_deinit(&ws->noise);
    fft_free(ws->galaxy_row);
    fft_free(ws->noise_row);
    fft_free(ws->no_noise);
    fft_free(ws->lines);
    fft_free(ws->pair);
    fft_free(ws->left);
    fft_free(ws->right);
    filter_map_deinit(&ws->fine);
    filter_map_deinit(&ws->coarse);
    transfer_scratch_deinit(&ws->scratch);
    transfer_deinit(&ws->transfer);
    free(ws);
}
