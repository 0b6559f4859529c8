/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocate a shear_block: memory for stamps, one allocation laid out as arrays. */
#include "fits/schema/field_columns.h"

#include <stdlib.h>
#include <string.h>

enum { ALIGN = 64 };

/* Round up, with a gap of at least a byte: galaxies and noise whose sizes are powers of two must
 * not share cache sets, pixel by pixel. */
static size_t with_gap(size_t bytes) {
    return (bytes / ALIGN + 1) * ALIGN;
}

/* Return the next `bytes` of the memory, aligned; without a base only count them. */
static void *place(char *base, size_t *at, size_t bytes) {
    void *here = base != NULL ? base + *at : NULL;
    *at += with_gap(bytes);
    return here;
}

static void place_columns(shear_block *b, const shear_field_info *info, char *base, size_t *at) {
    const size_t n = (size_t)b->capacity;
    for (const sf_column_def *def = sf_column_defs; def < sf_column_defs + SF_COLUMNS; def++) {
        if ((info->columns & def->bit) != 0 && def->in_block != 0) {
            const size_t size = def->form[0] == 'J' ? sizeof(int32_t) : sizeof(int64_t);
            const size_t repeat = (size_t)sf_column_repeat(def, info->psf_terms);
            void *array = place(base, at, n * repeat * size);
            memcpy((char *)b + def->in_block, &array, sizeof array);
        }
    }
}

/* Lay the arrays out and return their size. Sides are at most 4096, noise stamps at most 64 per
 * galaxy, and a capacity is an int, so that no product here overflows 64 bits. */
static size_t lay_out(shear_block *b, const shear_field_info *info, int capacity, char *base) {
    const shear_geometry *g = &info->geometry;
    const size_t n = (size_t)capacity;
    size_t at = 0;
    *b = (shear_block){.capacity = capacity};
    b->galaxy = place(base, &at, n * (size_t)g->nx * (size_t)g->ny * sizeof(double));
    const int planes = info->noise_planes > 1 ? info->noise_planes : 1;
    b->noise =
        place(base, &at, n * (size_t)planes * (size_t)g->nx * (size_t)g->ny * sizeof(double));
    if (info->psf_layout == SHEAR_PSF_MODELS)
        b->psf_index = place(base, &at, n * sizeof *b->psf_index);
    if (info->psf_layout == SHEAR_PSF_PER_STAMP || info->psf_layout == SHEAR_PSF_BY_ID) {
        b->psf = place(base, &at, n * (size_t)g->psf_nx * (size_t)g->psf_ny * sizeof(double));
        b->psf_index = place(base, &at, n * sizeof *b->psf_index);
        b->psf_id = place(base, &at, n * sizeof *b->psf_id);
    }
    place_columns(b, info, base, &at);
    if (info->carried_bytes > 0)
        b->carried = place(base, &at, n * (size_t)info->carried_bytes);
    b->stamps = (shear_stamps){.nx = g->nx,
                               .ny = g->ny,
                               .galaxy = b->galaxy,
                               .noise = b->noise,
                               .noise_planes = planes,
                               .psf = b->psf,
                               .psf_index = b->psf_index,
                               .weight = b->weight,
                               .r_gal = b->r_gal,
                               .mask = b->mask,
                               .jacobian = b->jacobian,
                               .psf_terms = b->psf_terms,
                               .flags = b->dropped};
    return at;
}

size_t shear_block_bytes(const shear_field_info *info, int capacity) {
    shear_block ignored;
    return lay_out(&ignored, info, capacity, NULL);
}

void shear_block_place(shear_block *block, const shear_field_info *info, int capacity,
                       void *memory) {
    lay_out(block, info, capacity, memory);
}

size_t shear_psf_bytes(const shear_field_info *info) {
    return with_gap((size_t)info->geometry.psf_nx * (size_t)info->geometry.psf_ny * sizeof(double));
}

int shear_block_new(shear_block **block, const shear_field_info *info, int capacity,
                    shear_error *err) {
    *block = NULL;
    if (capacity < 1) {
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "a block of %d stamps was asked for",
                          capacity);
    }
    const size_t bytes = shear_block_bytes(info, capacity);
    shear_block *b = malloc(sizeof *b);
    void *memory = aligned_alloc(ALIGN, bytes);
    if (b == NULL || memory == NULL) {
        free(b);
        free(memory);
        return shear_fail(err, SHEAR_E_NOMEM, "use smaller blocks",
                          "out of memory for a block of %d stamps", capacity);
    }
    memset(memory, 0, bytes);
    shear_block_place(b, info, capacity, memory);
    b->memory = memory;
    *block = b;
    return SHEAR_OK;
}

void shear_block_free(shear_block *block) {
    if (block != NULL) {
        free(block->memory);
        free(block);
    }
}
