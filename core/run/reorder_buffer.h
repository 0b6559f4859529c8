/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run/reorder_buffer.h: what finished turns leave, joined in index order; those that come early
 * wait.
 *
 * Not thread-safe: the work's lock is held.
 */
#ifndef SHEAR_RUN_REORDER_BUFFER_H
#define SHEAR_RUN_REORDER_BUFFER_H

#include "shear/sums.h"
#include "shear/symmetry.h"

/* What a turn of n whole blocks leaves. */
typedef struct finished {
    int64_t block;          /* its first */
    int n;                  /* blocks */
    shear_block_sums *sums; /* [n] */
    shear_symmetry *terms;  /* of its stamps; NULL where nobody wants terms */
} finished;

typedef struct joined {
    shear_field_sums *sums;
    shear_symmetry *terms;      /* of the same stamps, or NULL */
    shear_jackknife *jackknife; /* the caller's, or NULL; fed in block order */
    int64_t next_block;         /* the first block that is not in the sums */
    finished *waiting;          /* [room], n_waiting in use, in no order; owned copies */
    size_t n_waiting, room;
} joined;

int joined_init(joined *j, int64_t first_block, bool terms, shear_jackknife *jackknife,
                shear_error *err);
void joined_deinit(joined *j);
/* Take a turn's results (copied): join them, and all that waited for them, or have them wait. */
int joined_take(joined *j, const finished *f, shear_error *err);

#endif
