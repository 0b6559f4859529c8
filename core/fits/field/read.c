/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read a block of stamp pairs with their PSFs and catalog rows. */
#include "fits/field/internal.h"

#include "base/cleanup.h"

static int read_psf_per_stamp(field_file *f, int64_t first, int count, shear_block *block,
                              shear_error *err) {
    for (int i = 0; i < count; i++) {
        block->psf_index[i] = i;
        block->psf_id[i] = first + i;
    }
    block->stamps.n_psf = count;
    return sf_image_planes(&f->psf, first, count, block->psf, err);
}

/* Find the place of image `id` in the block, and read the image if it is not there yet. *index is
 * -1 if the file has no such image. */
static int locate_psf(field_file *f, int64_t id, shear_block *block, int32_t *index,
                      shear_error *err) {
    shear_stamps *stamps = &block->stamps;
    *index = -1;
    if (id < 0 || id >= f->base.info.n_psf)
        return SHEAR_OK;
    for (int k = stamps->n_psf - 1; k >= 0; k--) { /* consecutive stamps mostly have the same PSF */
        if (block->psf_id[k] == id) {
            *index = k;
            return SHEAR_OK;
        }
    }
    const shear_geometry *g = &f->base.info.geometry;
    *index = stamps->n_psf++;
    block->psf_id[*index] = id;
    return sf_image_planes(&f->psf, id, 1, block->psf + (int64_t)*index * g->psf_nx * g->psf_ny,
                           err);
}

static int read_psf_by_id(field_file *f, int64_t first, int count, shear_block *block,
                          shear_error *err) {
    const sf_column_def *def = &sf_column_defs[__builtin_ctz(SHEAR_COL_PSF_ID)];
    block->stamps.n_psf = 0;
    TRY(sf_columns_read(&f->catalog, def, first, count, block->psf_index, err));
    for (int i = 0; i < count; i++)
        TRY(locate_psf(f, block->psf_index[i], block, &block->psf_index[i], err));
    return SHEAR_OK;
}

static int read_psf(field_file *f, int64_t first, int count, shear_block *block, shear_error *err) {
    switch (f->base.info.psf_layout) {

    case SHEAR_PSF_PER_STAMP:
        return read_psf_per_stamp(f, first, count, block, err);
    case SHEAR_PSF_BY_ID:
        return read_psf_by_id(f, first, count, block, err);
    default:
        block->stamps.n_psf = 0;
        return SHEAR_OK;
    }
}

static int read_carried(field_file *f, int64_t first, int count, shear_block *block,
                        shear_error *err) {
    const size_t bytes = (size_t)f->base.info.carried_bytes;
    for (int i = 0; i < count && bytes > 0; i++)
        TRY(carry_rows_read(&f->carried_rows, first + i, block->carried + (size_t)i * bytes, err));
    return SHEAR_OK;
}

static int read_catalog(field_file *f, int64_t first, int count, shear_block *block,
                        shear_error *err) {
    for (const sf_column_def *def = sf_column_defs; def < sf_column_defs + SF_COLUMNS; def++) {
        if ((f->base.info.columns & def->bit) != 0 && def->in_block != 0) {
            TRY(sf_columns_read(&f->catalog, def, first, count,
                                sf_column_array(block, def->in_block), err));
        }
    }
    return SHEAR_OK;
}

int field_file_read_columns(shear_field *field, int64_t first, int count, shear_block *block,
                            shear_error *err) {
    field_file *f = field_file_of(field);
    const sf_column_def *id = &sf_column_defs[__builtin_ctz(SHEAR_COL_PSF_ID)];
    if (field->info.psf_layout == SHEAR_PSF_MODELS)
        TRY(sf_columns_read(&f->catalog, id, first, count, block->psf_index, err));
    TRY(read_carried(f, first, count, block, err));
    return read_catalog(f, first, count, block, err);
}

int field_file_read(shear_field *field, int64_t first, int count, shear_block *block,
                    shear_error *err) {
    field_file *f = field_file_of(field);
    const int64_t planes = field->info.noise_planes;
    TRY(sf_stamps_read(&f->galaxy, first, count, block->galaxy, err));
    TRY(sf_stamps_read(&f->noise, planes * first, planes * count, block->noise, err));
    TRY(read_psf(f, first, count, block, err));
    return field_file_read_columns(field, first, count, block, err);
}
