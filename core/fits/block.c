/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear_block: room for stamps in memory. */
#include "shear/field.h"

#include <stdbool.h>
#include <stdlib.h>

/* `wanted` ? calloc(count, size) : NULL; *ok becomes false where there is no room. */
static void *room(bool wanted, size_t count, size_t size, bool *ok) {
    if (!wanted) {
        return NULL;
    }
    void *memory = calloc(count, size);
    *ok = *ok && memory != NULL;
    return memory;
}

static bool allocate(shear_block *b, const shear_field_info *info) {
    const shear_geometry *g = &info->geometry;
    const size_t n = (size_t)b->capacity;
    const size_t pixels = (size_t)g->nx * (size_t)g->ny;
    const size_t psf_pixels = (size_t)g->psf_nx * (size_t)g->psf_ny;
    const bool many = info->psf_layout != SHEAR_PSF_ONE;
    const unsigned c = info->columns;
    bool ok = true;
    /* Sides are at most 4096, so that their product times 8 cannot overflow; calloc checks the
     * rest. */
    b->galaxy = room(true, n, pixels * sizeof(double), &ok);
    b->noise = room(true, n, pixels * sizeof(double), &ok);
    b->psf = room(many, n, psf_pixels * sizeof(double), &ok);
    b->psf_index = room(many, n, sizeof *b->psf_index, &ok);
    b->psf_id = room(many, n, sizeof *b->psf_id, &ok);
    b->id = room((c & SHEAR_COL_ID) != 0, n, sizeof *b->id, &ok);
    b->x = room((c & SHEAR_COL_X) != 0, n, sizeof(double), &ok);
    b->y = room((c & SHEAR_COL_Y) != 0, n, sizeof(double), &ok);
    b->ra = room((c & SHEAR_COL_RA) != 0, n, sizeof(double), &ok);
    b->dec = room((c & SHEAR_COL_DEC) != 0, n, sizeof(double), &ok);
    b->weight = room((c & SHEAR_COL_WEIGHT) != 0, n, sizeof(double), &ok);
    b->r_gal = room((c & SHEAR_COL_R_GAL) != 0, n, sizeof(double), &ok);
    b->mask = room((c & SHEAR_COL_FLAGS) != 0, n, sizeof *b->mask, &ok);
    return ok;
}

int shear_block_new(shear_block **block, const shear_field_info *info, int capacity,
                    shear_error *err) {
    *block = NULL;
    if (capacity < 1) {
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "a block of %d stamps was asked for",
                          capacity);
    }
    shear_block *b = calloc(1, sizeof *b);
    if (b != NULL) {
        b->capacity = capacity;
    }
    if (b == NULL || !allocate(b, info)) {
        shear_block_free(b);
        return shear_fail(err, SHEAR_E_NOMEM, "use smaller blocks",
                          "out of memory for a block of %d stamps", capacity);
    }
    b->stamps = (shear_stamps){.nx = info->geometry.nx,
                               .ny = info->geometry.ny,
                               .galaxy = b->galaxy,
                               .noise = b->noise,
                               .psf = b->psf,
                               .psf_index = b->psf_index,
                               .weight = b->weight,
                               .r_gal = b->r_gal,
                               .mask = b->mask};
    *block = b;
    return SHEAR_OK;
}

void shear_block_free(shear_block *block) {
    if (block == NULL) {
        return;
    }
    free(block->galaxy);
    free(block->noise);
    free(block->psf);
    free(block->psf_index);
    free(block->psf_id);
    free(block->id);
    free(block->x);
    free(block->y);
    free(block->ra);
    free(block->dec);
    free(block->weight);
    free(block->r_gal);
    free(block->mask);
    free(block);
}
