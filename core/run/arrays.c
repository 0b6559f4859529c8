/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measure arrays in the caller's memory like a field file, with the same plan, work and sums. */
#include "shear/arrays.h"

#include "base/cleanup.h"
#include "common/release.h"
#include "run/images.h"
#include "run/team.h"
#include "shear/run.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The arrays as a source of stamps. */
typedef struct array_source {
    const shear_arrays *in;
    shear_field_info info;
    images galaxy, noise, psf;
    shear_block **blocks; /* [threads]; their stamps are the caller's arrays, or copies of them */
    int threads;
} array_source;

/* ---- the field ---- */

static int check_geometry(const shear_geometry *g, shear_error *err) {
    const bool stamps = g->nx >= SHEAR_MIN_SIDE && g->nx <= SHEAR_MAX_SIDE &&
                        g->ny >= SHEAR_MIN_SIDE && g->ny <= SHEAR_MAX_SIDE;
    const bool psf = g->psf_nx >= SHEAR_MIN_PSF_SIDE && g->psf_nx <= SHEAR_MAX_PSF_SIDE &&
                     g->psf_ny >= SHEAR_MIN_PSF_SIDE && g->psf_ny <= SHEAR_MAX_PSF_SIDE;
    if (!stamps) {
        return shear_fail(err, SHEAR_E_FORMAT, NULL,
                          "stamps of %d x %d px: each side must be %d to %d px", g->nx, g->ny,
                          SHEAR_MIN_SIDE, SHEAR_MAX_SIDE);
    }
    if (!psf) {
        return shear_fail(err, SHEAR_E_FORMAT, NULL,
                          "PSF images of %d x %d samples: each side must have %d to %d", g->psf_nx,
                          g->psf_ny, SHEAR_MIN_PSF_SIDE, SHEAR_MAX_PSF_SIDE);
    }
    if (!(g->psf_oversample >= SHEAR_MIN_PSF_OVERSAMPLE) ||
        !(g->psf_oversample <= SHEAR_MAX_PSF_OVERSAMPLE)) {
        return shear_fail(err, SHEAR_E_FORMAT,
                          "give geometry.psf_oversample; 1 is one sample per pixel",
                          "%g PSF samples per pixel: there must be %g to %d", g->psf_oversample,
                          SHEAR_MIN_PSF_OVERSAMPLE, SHEAR_MAX_PSF_OVERSAMPLE);
    }
    return SHEAR_OK;
}

static int check_counts(const shear_field_info *info, const shear_arrays *in, shear_error *err) {
    if (in->n_stamps < 1) {
        return shear_fail(err, SHEAR_E_FORMAT, NULL, "there are %lld stamps",
                          (long long)in->n_stamps);
    }
    if (info->noise_planes < 1 || info->noise_planes > SHEAR_MAX_NOISE_PLANES) {
        return shear_fail(err, SHEAR_E_FORMAT, NULL,
                          "%d noise stamps per galaxy: there must be 1 to %d", info->noise_planes,
                          SHEAR_MAX_NOISE_PLANES);
    }
    if (info->n_psf < 1 ||
        (info->n_psf > 1 && in->psf_index == NULL && info->n_psf != in->n_stamps)) {
        return shear_fail(err, SHEAR_E_FORMAT,
                          "give one image, or one per stamp, or psf_index, which says whose is "
                          "which",
                          "there are %lld PSF images for %lld stamps", (long long)info->n_psf,
                          (long long)in->n_stamps);
    }
    return SHEAR_OK;
}

static enum shear_psf_layout psf_layout_of(const shear_arrays *in) {
    return in->n_psf <= 1          ? SHEAR_PSF_ONE
           : in->psf_index == NULL ? SHEAR_PSF_PER_STAMP
                                   : SHEAR_PSF_BY_ID;
}

static shear_field_info info_of(const shear_arrays *in) {
    return (shear_field_info){.pixscale = NAN,
                              .geometry = in->geometry,
                              .n_stamps = in->n_stamps,
                              .n_psf = in->n_psf == 0 ? 1 : in->n_psf,
                              .noise_planes = in->noise_planes == 0 ? 1 : in->noise_planes,
                              .psf_layout = psf_layout_of(in),
                              .columns = (in->weight != NULL ? SHEAR_COL_WEIGHT : 0u) |
                                         (in->r_gal != NULL ? SHEAR_COL_R_GAL : 0u) |
                                         (in->mask != NULL ? SHEAR_COL_FLAGS : 0u)};
}

/* ---- the source ---- */

static int init_images(array_source *s, shear_error *err) {
    const shear_geometry *g = &s->info.geometry;
    TRY(images_init(&s->galaxy, &s->in->galaxy, 1, g->nx, g->ny, "galaxy", err));
    TRY(images_init(&s->noise, &s->in->noise, s->info.noise_planes, g->nx, g->ny, "noise", err));
    return images_init(&s->psf, &s->in->psf, 1, g->psf_nx, g->psf_ny, "PSF", err);
}

static bool all_plain(const array_source *s) {
    return images_are_plain(&s->galaxy) && images_are_plain(&s->noise) &&
           (s->info.psf_layout == SHEAR_PSF_ONE || images_are_plain(&s->psf));
}

/* Make a block, with memory for copies only if they are needed. */
static int new_block(shear_block **block, const array_source *s, int capacity, shear_error *err) {
    if (!all_plain(s))
        return shear_block_new(block, &s->info, capacity, err);
    *block = calloc(1, sizeof **block);
    return *block != NULL ? SHEAR_OK
                          : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a block");
}

static int init_blocks(array_source *s, int threads, int capacity, shear_error *err) {
    s->blocks = calloc((size_t)threads, sizeof(shear_block *));
    if (s->blocks == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %d threads", threads);
    s->threads = threads;
    for (int i = 0; i < threads; i++)
        TRY(new_block(&s->blocks[i], s, capacity, err));
    return SHEAR_OK;
}

static int array_source_init(array_source *s, const shear_arrays *in, shear_error *err) {
    *s = (array_source){.in = in, .info = info_of(in)};
    TRY(check_geometry(&in->geometry, err));
    TRY(check_counts(&s->info, in, err));
    return init_images(s, err);
}

static void array_source_deinit(array_source *s) {
    for (int i = 0; i < s->threads; i++)
        shear_block_free(s->blocks[i]);
    free(s->blocks);
}

/* Convert the PSFs of stamps [first, first+count). Consecutive stamps mostly have the same one. */
static void convert_psfs(const array_source *s, int64_t first, int count, shear_block *block) {
    const shear_geometry *g = &s->info.geometry;
    const size_t samples = (size_t)g->psf_nx * (size_t)g->psf_ny;
    const int32_t *index = s->in->psf_index;
    int n = 0;
    assert(block->psf != NULL); /* because the PSFs are not plain */
    for (int i = 0; i < count; i++) {
        const int64_t wanted = index != NULL ? index[first + i] : first + i;
        if (wanted < 0 || wanted >= s->info.n_psf) {
            block->psf_index[i] = -1;
            continue;
        }
        if (n == 0 || block->psf_id[n - 1] != wanted) {
            images_copy(&s->psf, wanted, block->psf + (size_t)n * samples);
            block->psf_id[n++] = wanted;
        }
        block->psf_index[i] = n - 1;
    }
    block->stamps.n_psf = n;
    block->stamps.psf = block->psf;
    block->stamps.psf_index = block->psf_index;
}

static void set_psfs(const array_source *s, int64_t first, int count, shear_block *block) {
    shear_stamps *stamps = &block->stamps;
    if (s->info.psf_layout == SHEAR_PSF_ONE)
        return;
    if (!images_are_plain(&s->psf)) {
        convert_psfs(s, first, count, block);
    } else if (s->info.psf_layout == SHEAR_PSF_PER_STAMP) {
        stamps->psf = images_get(&s->psf, first, count, NULL);
        stamps->n_psf = count;
    } else {
        stamps->psf = images_get(&s->psf, 0, 1, NULL);
        stamps->n_psf = (int)s->info.n_psf;
        stamps->psf_index = s->in->psf_index + first;
    }
}

static int read_arrays(void *self, int slot, int64_t first, int count, const shear_block **out,
                       shear_error *err) {
    const array_source *s = self;
    const shear_arrays *in = s->in;
    shear_block *block = s->blocks[slot];
    (void)err;
    block->stamps = (shear_stamps){.first = first,
                                   .count = count,
                                   .nx = in->geometry.nx,
                                   .ny = in->geometry.ny,
                                   .galaxy = images_get(&s->galaxy, first, count, block->galaxy),
                                   .noise = images_get(&s->noise, first, count, block->noise),
                                   .noise_planes = s->info.noise_planes,
                                   .weight = in->weight != NULL ? in->weight + first : NULL,
                                   .r_gal = in->r_gal != NULL ? in->r_gal + first : NULL,
                                   .mask = in->mask != NULL ? in->mask + first : NULL};
    set_psfs(s, first, count, block);
    *out = block;
    return SHEAR_OK;
}

static int read_psf(void *self, int64_t index, double *out, shear_error *err) {
    const array_source *s = self;
    (void)err;
    images_copy(&s->psf, index, out);
    return SHEAR_OK;
}

/* ---- plan, measure, sum ---- */

static int make_plan(shear_plan **plan, array_source *s, const shear_settings *settings,
                     int capacity, shear_error *err) {
    const shear_psf_source psfs = {.self = s, .read = read_psf};
    const shear_source stamps = {.self = s, .read = read_arrays};
    CLEANUP(shear_plan_request_deinit) shear_plan_request request = {0};
    TRY(shear_plan_request_read(&request, settings, &s->info, psfs, err));
    TRY(shear_plan_request_sample(&request, &s->info, stamps,
                                  capacity < SHEAR_BLOCK ? capacity : SHEAR_BLOCK, err));
    return shear_plan_new(plan, &request, err);
}

static int keep_rows(void *self, int64_t first, int count, const shear_row *rows,
                     const shear_block *block, shear_error *err) {
    shear_row *all = self;
    (void)block;
    (void)err;
    memcpy(all + first, rows, (size_t)count * sizeof *rows);
    return SHEAR_OK;
}

/* Replace the errors of *result by those of a jackknife with so many groups. */
static int jackknife_errors(int groups, const shear_jackknife *blocks, shear_result *result,
                            shear_error *err) {
    CLEANUP(shear_jackknife_release) shear_jackknife *jackknife = NULL;
    TRY(shear_jackknife_new(&jackknife, groups, err));
    TRY(shear_jackknife_join(jackknife, blocks, err));
    return shear_jackknife_finish(jackknife, result, err);
}

int shear_measure_arrays(shear_result *result, const shear_arrays *arrays,
                         const shear_settings *settings, const shear_arrays_options *options,
                         shear_error *err) {
    static const shear_arrays_options defaults = {0};
    const shear_arrays_options *o = options != NULL ? options : &defaults;
    CLEANUP(shear_plan_release) shear_plan *plan = NULL;
    CLEANUP(array_source_deinit) array_source source;
    CLEANUP(team_sums_deinit) team_sums sums = {0};
    shear_result found;
    TRY(array_source_init(&source, arrays, err));
    const int threads = team_threads(o->threads);
    const shear_unit_size size = shear_unit_size_for(&source.info, threads);
    TRY(init_blocks(&source, threads, size.stamps, err));
    TRY(make_plan(&plan, &source, settings, size.stamps, err));
    const team_job job = {
        .work = {.info = &source.info,
                 .plan = plan,
                 .source = {.self = &source, .read = read_arrays, .concurrent = true},
                 .sink = {.self = o->rows, .write = o->rows != NULL ? keep_rows : NULL},
                 .size = size},
        .threads = threads,
        .jackknife = o->jackknife != 0,
        .progress = o->progress,
        .context = o->context};
    TRY(team_measure(&job, &sums, &found, err));
    if (o->jackknife != 0)
        TRY(jackknife_errors(o->jackknife, sums.jackknife, &found, err));
    if (o->sums != NULL)
        shear_field_sums_join(o->sums, sums.sums);
    if (o->plan != NULL)
        *o->plan = *shear_plan_get_info(plan);
    *result = found;
    return SHEAR_OK;
}
