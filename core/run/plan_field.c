/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Make the plan for a field file; its PSF, and a sample of its stamps, decide the automatic
 * settings. */
#include "shear/run.h"

#include "base/cleanup.h"
#include "base/sort.h"
#include "measure/reach.h"
#include "run/file_source.h"

#include <stdlib.h>

enum { MAX_PSFS_FOR_RADIUS = 256, MAX_SAMPLED_BLOCKS = 32 };

/* ---- a sample of the PSFs ---- */

/* Examine evenly spaced PSFs. `psf` is memory for one image, `each` for the results. */
static int look_at_some(shear_psf_source psfs, const shear_field_info *info, double *psf,
                        shear_psf_quality *each, shear_plan_request *request, shear_error *err) {
    const shear_geometry *g = &info->geometry;
    const int64_t tries = info->n_psf < MAX_PSFS_FOR_RADIUS ? info->n_psf : MAX_PSFS_FOR_RADIUS;
    shear_error why = {0};
    for (int64_t i = 0; i < tries; i++) {
        TRY(psfs.read(psfs.self, i * info->n_psf / tries, psf, err));
        const bool usable = shear_psf_examine(&each[request->n_psfs], psf, g->psf_nx, g->psf_ny,
                                              g->psf_oversample, &why) == SHEAR_OK;
        request->n_psfs += usable;
        request->n_unusable += !usable;
    }
    return request->n_psfs > 0
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_PSF, why.advice, "none of %lld PSFs is usable: %s",
                            (long long)tries, why.message);
}

static double median_radius(const shear_plan_request *request) {
    double radius[MAX_PSFS_FOR_RADIUS];
    for (int i = 0; i < request->n_psfs; i++)
        radius[i] = request->psfs[i].r_psf_px;
    sort_doubles(radius, (size_t)request->n_psfs);
    return radius[request->n_psfs / 2];
}

/* Read the sample of a field whose stamps have PSFs of their own. Unusable PSFs are left out of the
 * radius. */
static int read_sample(shear_plan_request *request, const shear_field_info *info,
                       shear_psf_source psfs, double *psf, shear_error *err) {
    shear_psf_quality *each = calloc(MAX_PSFS_FOR_RADIUS, sizeof *each);
    request->psfs = each;
    if (each == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a plan");
    const int code = look_at_some(psfs, info, psf, each, request, err);
    request->r_psf_px = code == SHEAR_OK ? median_radius(request) : 0.0;
    return code;
}

int shear_plan_request_read(shear_plan_request *request, const shear_settings *settings,
                            const shear_field_info *info, shear_psf_source psfs, shear_error *err) {
    const shear_geometry *g = &info->geometry;
    *request = (shear_plan_request){
        .settings = settings, .geometry = *g, .has_r_gal = (info->columns & SHEAR_COL_R_GAL) != 0};
    if (info->n_models > 0) { /* HACK */
        const shear_psf_model *m = NULL;
        shear_field_get_models(psfs.self, &m);
        request->models = m; request->n_models = info->n_models; request->frame = info->frame; request->pixel_scale = info->pixscale;
        TRY(shear_psf_radius(m->samples, m->nx, m->ny, 1, &request->r_psf_px, err));
        request->r_psf_px *= m->step;
        return SHEAR_OK;
    }
    CLEANUP(release_free)
    double *psf = malloc((size_t)g->psf_nx * (size_t)g->psf_ny * sizeof *psf);
    if (psf == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a PSF of %d x %d samples",
                          g->psf_nx, g->psf_ny);
    }
    const bool one = info->psf_layout == SHEAR_PSF_ONE;
    const int code =
        one ? psfs.read(psfs.self, 0, psf, err) : read_sample(request, info, psfs, psf, err);
    if (code != SHEAR_OK) {
        shear_plan_request_deinit(request);
        return code;
    }
    request->psf = one ? CLEANUP_TAKE(psf) : NULL;
    return SHEAR_OK;
}

void shear_plan_request_deinit(shear_plan_request *request) {
    free((void *)request->psf);
    free((void *)request->psfs);
    *request = (shear_plan_request){0};
}

/* ---- a sample of the stamps: how far do the galaxies reach? ---- */

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

static int read_stamps(reach *r, const shear_field_info *info, shear_source source, int capacity,
                       shear_error *err) {
    const int64_t blocks = (info->n_stamps + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
    const int64_t tries = blocks < MAX_SAMPLED_BLOCKS ? blocks : MAX_SAMPLED_BLOCKS;
    for (int64_t i = 0; i < tries; i++) {
        const int64_t first = i * blocks / tries * SHEAR_BLOCK;
        const int64_t end =
            first + SHEAR_BLOCK < info->n_stamps ? first + SHEAR_BLOCK : info->n_stamps;
        TRY(read_sampled(r, source, first, end, capacity, err));
    }
    return SHEAR_OK;
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
    TRY(read_stamps(&r, info, source, capacity, err));
    return reach_core(&r, radii.r_psf_px, radii.beta_px, radii.width_px, &request->core_px)
               ? SHEAR_OK
               : out_of_memory(err);
}

/* ---- the plan ---- */

static int read_from_file(void *self, int64_t index, double *out, shear_error *err) {
    return shear_field_read_psf(self, index, out, err);
}

static int sample_file(shear_plan_request *request, shear_field *field, shear_error *err) {
    const shear_field_info *info = shear_field_get_info(field);
    if (!shear_plan_wants_core(request))
        return SHEAR_OK;
    const shear_unit_size size = shear_unit_size_for(info, 1);
    const int capacity = size.stamps < SHEAR_BLOCK ? size.stamps : SHEAR_BLOCK;
    CLEANUP(file_source_deinit) file_source source;
    TRY(file_source_init(&source, field, 1, capacity, err));
    return shear_plan_request_sample(request, info, file_source_as_source(&source), capacity, err);
}

int shear_plan_for_field(shear_plan **plan, const shear_settings *settings, shear_field *field,
                         shear_error *err) {
    const shear_field_info *info = shear_field_get_info(field);
    const shear_psf_source psfs = {.self = field, .read = read_from_file};
    CLEANUP(shear_plan_request_deinit) shear_plan_request request = {0};
    *plan = NULL;
    TRY(shear_plan_request_read(&request, settings, info, psfs, err));
    TRY(sample_file(&request, field, err));
    return shear_plan_new(plan, &request, err);
}
