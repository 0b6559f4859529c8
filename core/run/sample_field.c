/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sample a field's stamps to find how far its galaxies reach: shear_plan_request_sample(). */
#include "base/cleanup.h"
#include "measure/reach.h"
#include "shear/run.h"

enum { MAX_SAMPLED_BLOCKS = 32 };

static bool counts(const shear_stamps *s, int i) {
    const bool weighs =
        s->weight == NULL || (shear_weight_is_good(s->weight[i]) && s->weight[i] > 0);
    return weighs && (s->mask == NULL || s->mask[i] == 0);
}

static void add_stamps(reach *r, const shear_stamps *s) {
    const size_t pixels = (size_t)s->nx * (size_t)s->ny;
    for (int i = 0; i < s->count; i++) {
        if (counts(s, i))
            reach_add(r, s->galaxy + (size_t)i * pixels, s->noise + (size_t)i * pixels);
    }
}

/* Read and add one block of the sample. */
static int read_sampled(reach *r, shear_source source, int64_t first, int64_t end, int capacity,
                        shear_error *err) {
    const shear_block *block = NULL;
    for (; first < end; first += capacity) {
        const int count = end - first < capacity ? (int)(end - first) : capacity;
        TRY(source.read(source.self, 0, first, count, &block, err));
        add_stamps(r, &block->stamps);
    }
    return SHEAR_OK;
}

static int read_sample(reach *r, const shear_field_info *info, shear_source source, int capacity,
                       shear_error *err) {
    const int64_t blocks = (info->n_stamps + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
    const int64_t tries = blocks < MAX_SAMPLED_BLOCKS ? blocks : MAX_SAMPLED_BLOCKS;
    int code = SHEAR_OK;
    for (int64_t i = 0; i < tries && code == SHEAR_OK; i++) {
        const int64_t first = i * blocks / tries * SHEAR_BLOCK;
        const int64_t end =
            first + SHEAR_BLOCK < info->n_stamps ? first + SHEAR_BLOCK : info->n_stamps;
        code = read_sampled(r, source, first, end, capacity, err);
    }
    return code;
}

static int out_of_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a sample");
}

int shear_plan_request_sample(shear_plan_request *request, const shear_field_info *info,
                              shear_source source, int capacity, shear_error *err) {
    const shear_geometry *g = &info->geometry;
    shear_plan_radii radii;
    if (!shear_plan_wants_core(request))
        return SHEAR_OK;
    TRY(shear_plan_find_radii(&radii, request, err));
    CLEANUP(reach_deinit) reach r;
    if (!reach_init(&r, g->nx, g->ny, MAX_SAMPLED_BLOCKS * SHEAR_BLOCK))
        return out_of_memory(err);
    TRY(read_sample(&r, info, source, capacity, err));
    return reach_core(&r, radii.r_psf_px, radii.beta_px, radii.width_px, &request->core_px)
               ? SHEAR_OK
               : out_of_memory(err);
}
