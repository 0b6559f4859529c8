/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/scratch.h: the temporary files that a reader unpacks into. They have no names, and are
 * opened for the reader before it starts, because it may not open files. The daemon watches their
 * size while the reader works, as the kernel reports it, because the reader is not trusted. */
#pragma once

#include "shear/error.h"
#include "shear/input.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct scratch {
    int fds[SHEAR_N_PARTS]; /* -1: none */
    const char *directory;
    int64_t most;       /* limit of the bytes of all readers' files together */
    atomic_llong *used; /* counter of these bytes; may be NULL */
    int64_t own;        /* bytes of this reader's files, included in *used */
} scratch;

/* Open `n` files; fewer if that fails. A reader that lacks one reports that. */
void scratch_open(scratch *s, const char *directory, int64_t most, atomic_llong *used, int n);
void scratch_close(scratch *s);

/* Check the room that the files take. `full`: the reader has reported a full disk. Return SHEAR_OK;
 * SHEAR_E_FORMAT if they take more than there could ever be room for; or SHEAR_E_FULL if there is
 * not enough room now (some of the disk is left free for others). */
int scratch_check(scratch *s, bool full, shear_error *err);

/* Find a directory for files without names: `wanted`, which is created if missing; or, if that is
 * "", the first that works of $TMPDIR, /var/tmp and `otherwise`. Return SHEAR_OK with the path in
 * `out`, or SHEAR_E_IO. */
int scratch_find(char *out, size_t size, const char *wanted, const char *otherwise,
                 shear_error *err);
