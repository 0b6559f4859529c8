/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/sandbox.h: what the reader child may do: read its files, use one scratch directory for
 * unpacking, answer its socket. */
#ifndef SHEARD_READER_SANDBOX_H
#define SHEARD_READER_SANDBOX_H

#include "shear/error.h"

#include <stdint.h>

typedef struct sandbox_limits {
    int64_t memory_bytes; /* address space */
    int64_t cpu_seconds;
    int64_t file_bytes; /* largest unpacked file */
} sandbox_limits;

/* Enter it, for good: resource limits, no new privileges, not dumpable, Landlock (files), seccomp
 * (system calls). file_fds [n_files], -1 for none. scratch: the directory in which unpacked copies
 * may be made. Landlock may be missing in old kernels: *landlocked says. */
int sandbox_enter(const sandbox_limits *limits, const int *file_fds, int n_files,
                  const char *scratch, int *landlocked, shear_error *err);

#endif
