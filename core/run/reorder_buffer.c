/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/reorder_buffer.h"

#include "base/array.h"
#include "base/cleanup.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

int reorder_buffer_init(reorder_buffer *b, int64_t first_block, bool terms,
                        shear_jackknife *jackknife, shear_error *err) {
    *b = (reorder_buffer){.next_block = first_block, .jackknife = jackknife};
    TRY(shear_field_sums_new(&b->sums, err));
    return terms ? shear_symmetry_new(&b->terms, err) : SHEAR_OK;
}

static void block_result_deinit(block_result *r) {
    free(r->sums);
    shear_symmetry_free(r->terms);
}

void reorder_buffer_deinit(reorder_buffer *b) {
    for (size_t i = 0; i < b->n_early; i++)
        block_result_deinit(&b->early[i]);
    free(b->early);
    shear_field_sums_free(b->sums);
    shear_symmetry_free(b->terms);
    *b = (reorder_buffer){0};
}

/* Add the blocks that come next. */
static int sum_next(reorder_buffer *b, const block_result *r, shear_error *err) {
    assert(r->block == b->next_block);
    if (r->terms != NULL)
        TRY(shear_symmetry_join(b->terms, r->terms, 0, err));
    for (int i = 0; i < r->n; i++) {
        if (b->jackknife != NULL)
            TRY(shear_jackknife_add(b->jackknife, &r->sums[i], err));
        shear_field_sums_add(b->sums, &r->sums[i]);
    }
    b->next_block += r->n;
    return SHEAR_OK;
}

static int copy_terms(shear_symmetry **copy, const shear_symmetry *terms, shear_error *err) {
    if (terms == NULL)
        return SHEAR_OK;
    TRY(shear_symmetry_new(copy, err));
    return shear_symmetry_join(*copy, terms, 0, err);
}

static int keep_early(reorder_buffer *b, const block_result *r, shear_error *err) {
    const size_t bytes = (size_t)r->n * sizeof *r->sums;
    CLEANUP(block_result_deinit)
    block_result copy = {.block = r->block, .n = r->n, .sums = malloc(bytes)};
    if (copy.sums == NULL || !ARRAY_RESERVE(b->early, b->capacity, b->n_early + 1))
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the results of blocks");
    memcpy(copy.sums, r->sums, bytes);
    TRY(copy_terms(&copy.terms, r->terms, err));
    b->early[b->n_early++] = copy;
    copy = (block_result){0};
    return SHEAR_OK;
}

/* Add all kept results that come next now. */
static int sum_early(reorder_buffer *b, shear_error *err) {
    for (size_t i = 0; i < b->n_early;) {
        if (b->early[i].block != b->next_block) {
            i++;
            continue;
        }
        CLEANUP(block_result_deinit) block_result next = b->early[i];
        b->early[i] = b->early[--b->n_early];
        TRY(sum_next(b, &next, err));
        i = 0;
    }
    return SHEAR_OK;
}

int reorder_buffer_add(reorder_buffer *b, const block_result *r, shear_error *err) {
    assert(r->block >= b->next_block);
    if (r->block != b->next_block)
        return keep_early(b, r, err);
    TRY(sum_next(b, r, err));
    return sum_early(b, err);
}
