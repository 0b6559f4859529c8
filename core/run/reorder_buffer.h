/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run/reorder_buffer.h: sum the results of blocks in the order of the blocks.
 *
 * Threads finish blocks in any order; early results are kept until their predecessors have been
 * summed. Not thread-safe: the caller holds the lock of the work. */
#pragma once

#include "shear/sums.h"
#include "shear/symmetry.h"

/* The result of a work unit of n whole blocks. */
typedef struct block_result {
    int64_t block;          /* number of its first block */
    int n;                  /* number of blocks */
    shear_block_sums *sums; /* [n] */
    shear_symmetry *terms;  /* of its stamps; NULL if no terms are needed */
} block_result;

typedef struct reorder_buffer {
    shear_field_sums *sums;
    shear_symmetry *terms;      /* of the same stamps, or NULL */
    shear_jackknife *jackknife; /* the caller's, or NULL; gets the blocks in order */
    int64_t next_block;         /* the first block that is not in the sums */
    block_result *early;        /* [capacity], n_early in use, in any order; owned copies */
    size_t n_early, capacity;
} reorder_buffer;

int reorder_buffer_init(reorder_buffer *b, int64_t first_block, bool terms,
                        shear_jackknife *jackknife, shear_error *err);
void reorder_buffer_deinit(reorder_buffer *b);
/* Add a unit's results, which are copied: sum them, and all kept results that follow, or keep them
 * until they can be summed. Errors: SHEAR_E_NOMEM. */
int reorder_buffer_add(reorder_buffer *b, const block_result *r, shear_error *err);
