/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Make the plan for a field file; its PSF, and a sample of its stamps, decide the automatic
 * settings. */
#include "shear/run.h"

#include "base/cleanup.h"
#include "base/sort.h"
#include "measure/reach.h"
#include "run/file_source.h"
#include "run/positions.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_PSFS_FOR_RADIUS = 256, MAX_MODEL_STAMPS = 64, MAX_SAMPLED_BLOCKS = 32 };

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

/* Read the field's one PSF, or look at a sample. */
static int read_images(shear_plan_request *request, const shear_field_info *info,
                       shear_psf_source psfs, shear_error *err) {
    const shear_geometry *g = &info->geometry;
    CLEANUP(release_free)
    double *psf = malloc((size_t)g->psf_nx * (size_t)g->psf_ny * sizeof *psf);
    if (psf == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a PSF of %d x %d samples",
                          g->psf_nx, g->psf_ny);
    }
    if (info->psf_layout != SHEAR_PSF_ONE)
        return read_sample(request, info, psfs, psf, err);
    TRY(psfs.read(psfs.self, 0, psf, err));
    request->psf = CLEANUP_TAKE(psf);
    return SHEAR_OK;
}

/* ---- a sample of the galaxies, whose PSFs are those of models ---- */

/* The usable PSFs of the sample. */
typedef struct model_sample {
    shear_psf_quality quality[MAX_MODEL_STAMPS];
    int model[MAX_MODEL_STAMPS];
    double *terms; /* [MAX_MODEL_STAMPS][terms] */
} model_sample;

static void model_sample_deinit(model_sample *s) {
    free(s->terms);
}

/* Look at the PSF of the first of stamps [first, end) that has one, and keep it if it is usable.
 * *why gets what is wrong with it. */
static int look_at_stamp(model_sample *s, int64_t first, int64_t end, const shear_psf_source *psfs,
                         shear_plan_request *request, shear_error *why, shear_error *err) {
    const int i = request->n_psfs;
    double *terms = s->terms + (size_t)i * (size_t)psfs->models[0].terms;
    for (bool found = false; !found; first++) {
        if (first >= end)
            return SHEAR_OK;
        TRY(psfs->read_terms(psfs->self, first, &s->model[i], terms, err));
        found = s->model[i] >= 0 && s->model[i] < request->n_models;
    }
    const bool usable = shear_psf_model_examine(&s->quality[i], &request->models[s->model[i]],
                                                terms, request->pixel_scale, why) == SHEAR_OK;
    request->n_psfs += usable;
    request->n_unusable += !usable;
    return SHEAR_OK;
}

/* Keep the qualities, and the coefficients of the galaxy with the median radius. */
static int keep_sample(shear_plan_request *request, const model_sample *s, int n_terms,
                       shear_error *err) {
    shear_psf_quality *each = malloc(sizeof s->quality);
    double *terms = malloc((size_t)n_terms * sizeof *terms);
    request->psfs = each;
    request->terms = terms;
    if (each == NULL || terms == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a plan");
    memcpy(each, s->quality, sizeof s->quality);
    request->r_psf_px = median_radius(request);
    int typical = 0;
    while (each[typical].r_psf_px != request->r_psf_px)
        typical++;
    memcpy(terms, s->terms + (size_t)typical * (size_t)n_terms, (size_t)n_terms * sizeof *terms);
    request->model = s->model[typical];
    return SHEAR_OK;
}

static int read_models(shear_plan_request *request, const shear_field_info *info,
                       shear_psf_source psfs, shear_error *err) {
    const int n_terms = psfs.models[0].terms;
    const int64_t most = info->n_models == 1 && n_terms == 1 ? 1 : MAX_MODEL_STAMPS; /* constant */
    const int64_t tries = info->n_stamps < most ? info->n_stamps : most;
    shear_error why = {.message = "no stamp has one"};
    CLEANUP(model_sample_deinit)
    model_sample s = {.terms = calloc((size_t)MAX_MODEL_STAMPS * (size_t)n_terms, sizeof *s.terms)};
    request->models = psfs.models;
    request->n_models = info->n_models;
    if (s.terms == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a plan");
    for (int64_t i = 0; i < tries; i++) {
        const int64_t first = i * info->n_stamps / tries;
        const int64_t end = (i + 1) * info->n_stamps / tries;
        TRY(look_at_stamp(&s, first, end, &psfs, request, &why, err));
    }
    if (request->n_psfs == 0) {
        return shear_fail(err, SHEAR_E_PSF, why.advice, "none of %lld PSFs is usable: %s",
                          (long long)tries, why.message);
    }
    return keep_sample(request, &s, n_terms, err);
}

int shear_plan_request_read(shear_plan_request *request, const shear_settings *settings,
                            const shear_field_info *info, shear_psf_source psfs, shear_error *err) {
    *request = (shear_plan_request){.settings = settings,
                                    .geometry = info->geometry,
                                    .frame = info->frame,
                                    .pixel_scale = info->pixscale > 0.0 ? info->pixscale : 0.0,
                                    .has_r_gal = (info->columns & SHEAR_COL_R_GAL) != 0};
    const int code = info->n_models > 0 ? read_models(request, info, psfs, err)
                                        : read_images(request, info, psfs, err);
    if (code != SHEAR_OK)
        shear_plan_request_deinit(request);
    return code;
}

void shear_plan_request_deinit(shear_plan_request *request) {
    free((void *)request->psf);
    free((void *)request->psfs);
    free((void *)request->terms);
    *request = (shear_plan_request){0};
}

/* ---- a sample of the stamps: how far do the galaxies reach? ---- */

static bool counts(const shear_stamps *s, int i) {
    const bool whole = s->flags == NULL || s->flags[i] == 0;
    const bool weighs =
        s->weight == NULL || (shear_weight_is_good(s->weight[i]) && s->weight[i] > 0);
    return whole && weighs && (s->mask == NULL || s->mask[i] == 0);
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
    if (positions_known(info))
        TRY(positions_check(&request->centring, info, source, capacity, err));
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

static int sample_file(shear_plan_request *request, shear_field *field, shear_error *err) {
    const shear_field_info *info = shear_field_get_info(field);
    if (!shear_plan_wants_core(request) && !positions_known(info))
        return SHEAR_OK;
    const shear_unit_size size = shear_unit_size_for(info, 1);
    const int capacity = size.stamps < SHEAR_BLOCK ? size.stamps : SHEAR_BLOCK;
    CLEANUP(file_source_deinit) file_source source;
    TRY(file_source_init(&source, field, 1, capacity, err));
    return shear_plan_request_sample(request, info, file_source_as_source(&source), capacity, err);
}

/* A field whose stamps are read one by one. */
typedef struct stamp_reader {
    shear_field *field;
    shear_block *block; /* of one stamp */
} stamp_reader;

static void stamp_reader_deinit(stamp_reader *r) {
    shear_block_free(r->block);
}

static int read_psf(void *self, int64_t index, double *out, shear_error *err) {
    const stamp_reader *r = self;
    return shear_field_read_psf(r->field, index, out, err);
}

static int read_terms(void *self, int64_t stamp, int *model, double *terms, shear_error *err) {
    const stamp_reader *r = self;
    const shear_stamps *s = &r->block->stamps;
    const int n_terms = shear_field_get_info(r->field)->psf_terms;
    TRY(shear_field_read_columns(r->field, stamp, 1, r->block, err));
    const bool without = s->flags != NULL && (s->flags[0] & SHEAR_FLAGS_WITHOUT_PSF) != 0;
    *model = without ? -1 : s->psf_index != NULL ? s->psf_index[0] : 0;
    memcpy(terms, s->psf_terms, (size_t)n_terms * sizeof *terms);
    return SHEAR_OK;
}

int shear_plan_for_field(shear_plan **plan, const shear_settings *settings, shear_field *field,
                         shear_error *err) {
    const shear_field_info *info = shear_field_get_info(field);
    CLEANUP(stamp_reader_deinit) stamp_reader reader = {.field = field};
    shear_psf_source psfs = {.self = &reader, .read = read_psf, .read_terms = read_terms};
    CLEANUP(shear_plan_request_deinit) shear_plan_request request = {0};
    *plan = NULL;
    if (shear_field_get_models(field, &psfs.models) > 0)
        TRY(shear_block_new(&reader.block, info, 1, err));
    TRY(shear_plan_request_read(&request, settings, info, psfs, err));
    TRY(sample_file(&request, field, err));
    return shear_plan_new(plan, &request, err);
}
