/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/extraction.h"

#include "base/cleanup.h"

#include <stdlib.h>

enum { CAPACITY = 64 };

/* What a copy owns. */
typedef struct extraction {
    shear_field_writer *writer;
    shear_block *block;
    double *psf;     /* one image */
    int32_t *psf_id; /* [CAPACITY] */
} extraction;

static void extraction_deinit(extraction *e) {
    shear_field_abort(e->writer);
    shear_block_free(e->block);
    free(e->psf);
    free(e->psf_id);
}

static shear_field_spec spec_of(const shear_field *field, const char *name, bool overwrite) {
    const shear_field_info *info = shear_field_get_info(field);
    shear_field_spec spec = {.name = name != NULL            ? name
                                     : info->name[0] != '\0' ? info->name
                                                             : NULL,
                             .pixscale = info->pixscale,
                             .has_truth = info->has_truth,
                             .sim_g1 = info->sim_g1,
                             .sim_g2 = info->sim_g2,
                             .geometry = info->geometry,
                             .n_stamps = info->n_stamps,
                             .n_psf = info->n_psf,
                             .noise_planes = info->noise_planes,
                             .frame = info->frame,
                             .columns = info->columns,
                             .carried = info->carried,
                             .n_carried = info->n_carried,
                             .bitpix = -64, /* to the last bit */
                             .overwrite = overwrite};
    spec.n_models = shear_field_get_models(field, &spec.models);
    return spec;
}

/* ---- the PSFs ---- */

static int copy_images(extraction *e, shear_field *field, shear_error *err) {
    const int64_t n = shear_field_get_info(field)->n_psf;
    for (int64_t i = 0; i < n; i++) {
        TRY(shear_field_read_psf(field, i, e->psf, err));
        TRY(shear_field_write_psf(e->writer, i, e->psf, err));
    }
    return SHEAR_OK;
}

/* ---- the stamps ---- */

/* Fill the numbers that column PSF_ID has for the stamps of the block. */
static void number_psfs(extraction *e, const shear_field_info *info) {
    const shear_block *b = e->block;
    for (int i = 0; i < b->stamps.count && b->psf_index != NULL; i++) {
        const int32_t index = b->psf_index[i];
        e->psf_id[i] = info->n_models > 0 || index < 0 ? index : (int32_t)b->psf_id[index];
    }
}

static int copy_block(extraction *e, shear_field *field, int64_t first, int count,
                      shear_error *err) {
    const shear_block *b = e->block;
    TRY(shear_field_read(field, first, count, e->block, err));
    number_psfs(e, shear_field_get_info(field));
    const shear_catalog_columns columns = {.id = b->id,
                                           .x = b->x,
                                           .y = b->y,
                                           .ra = b->ra,
                                           .dec = b->dec,
                                           .weight = b->weight,
                                           .r_gal = b->r_gal,
                                           .psf_id = e->psf_id,
                                           .flags = b->mask,
                                           .gf1 = b->gf1,
                                           .gf2 = b->gf2,
                                           .jacobian = b->jacobian,
                                           .psf_terms = b->psf_terms,
                                           .dropped = b->dropped,
                                           .carried = b->carried};
    return shear_field_write(e->writer, first, count, b->galaxy, b->noise, &columns, err);
}

static int copy_stamps(extraction *e, shear_field *field, progress *bar, shear_error *err) {
    const int64_t n = shear_field_get_info(field)->n_stamps;
    for (int64_t first = 0; first < n; first += CAPACITY) {
        const int count = n - first < CAPACITY ? (int)(n - first) : CAPACITY;
        TRY(copy_block(e, field, first, count, err));
        if (progress_callback(bar, first + count, n) != 0)
            return shear_fail(err, SHEAR_E_CANCELLED, NULL, "interrupted");
    }
    return SHEAR_OK;
}

int extraction_write(shear_field *field, const char *path, const char *name, bool overwrite,
                     progress *bar, shear_error *err) {
    const shear_field_info *info = shear_field_get_info(field);
    const shear_field_spec spec = spec_of(field, name, overwrite);
    CLEANUP(extraction_deinit) extraction e = {0};
    e.psf = malloc((size_t)info->geometry.psf_nx * (size_t)info->geometry.psf_ny * sizeof *e.psf);
    e.psf_id = calloc(CAPACITY, sizeof *e.psf_id);
    if (e.psf == NULL || e.psf_id == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field file");
    TRY(shear_block_new(&e.block, info, CAPACITY, err));
    TRY(shear_field_create(&e.writer, path, &spec, err));
    TRY(copy_images(&e, field, err));
    TRY(copy_stamps(&e, field, bar, err));
    return shear_field_finish(CLEANUP_TAKE(e.writer), err);
}
