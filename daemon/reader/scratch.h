/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/scratch.h: the files that a reader unpacks into. They have no names and are opened for it
 * before it starts, so that it may open none itself; and they are watched while it works: what they
 * take is the kernel's word, and no promise of the reader's. */
#ifndef SHEARD_READER_SCRATCH_H
#define SHEARD_READER_SCRATCH_H

#include "shear/error.h"
#include "shear/input.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct scratch {
    int fds[SHEAR_N_PARTS]; /* -1: none */
    const char *directory;
    int64_t most;       /* bytes that those of all readers may take together */
    atomic_llong *used; /* what they take */
    int64_t own;        /* of it, this reader's */
} scratch;

/* Open `n` of them. Where that fails there are fewer: a reader that needs one will say so. */
void scratch_open(scratch *s, const char *directory, int64_t most, atomic_llong *used, int n);
void scratch_close(scratch *s);

/* What they take now may stay: SHEAR_OK. SHEAR_E_FORMAT: more than there could ever be room for.
 * SHEAR_E_FULL: there is no room now; a part of the disk is left to others. `full`: the reader has
 * found the disk full itself. */
int scratch_check(scratch *s, bool full, shear_error *err);

/* Where files without names can be made: `wanted`, made where it is missing; or, where that is "",
 * $TMPDIR, /var/tmp or `otherwise`, the first that works. SHEAR_OK and `out`, or SHEAR_E_IO. */
int scratch_find(char *out, size_t size, const char *wanted, const char *otherwise,
                 shear_error *err);

#endif
