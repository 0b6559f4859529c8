/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run/reorder_buffer.h: results of blocks, summed in the order of the blocks. Threads finish them
 * in any order; those that come early are kept until their turn.
 *
 * Not thread-safe: the lock of the work is held.
 */
#ifndef SHEAR_RUN_REORDER_BUFFER_H
#define SHEAR_RUN_REORDER_BUFFER_H

#include "shear/sums.h"
#include "shear/symmetry.h"

/* What a unit of n whole blocks leaves. */
typedef struct block_result {
    int64_t block;          /* its first */
    int n;                  /* blocks */
    shear_block_sums *sums; /* [n] */
    shear_symmetry *terms;  /* of its stamps; NULL if nobody wants terms */
} block_result;

typedef struct reorder_buffer {
    shear_field_sums *sums;
    shear_symmetry *terms;      /* of the same stamps, or NULL */
    shear_jackknife *jackknife; /* the caller's, or NULL; fed in block order */
    int64_t next_block;         /* the first block that is not in the sums */
    block_result *early;        /* [capacity], n_early in use, in no order; owned copies */
    size_t n_early, capacity;
} reorder_buffer;

int reorder_buffer_init(reorder_buffer *b, int64_t first_block, bool terms,
                        shear_jackknife *jackknife, shear_error *err);
void reorder_buffer_deinit(reorder_buffer *b);
/* Add a unit's results (copied): sum them, and all that follow and are here already, or keep them.
 */
int reorder_buffer_add(reorder_buffer *b, const block_result *r, shear_error *err);

#endif
