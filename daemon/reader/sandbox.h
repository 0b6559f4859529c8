/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/sandbox.h: what the reader child may do: read and write what is open, take memory, answer
 * its socket, and end. It opens nothing, no call takes a path or another process, and no memory
 * becomes code. */
#ifndef SHEARD_READER_SANDBOX_H
#define SHEARD_READER_SANDBOX_H

#include "shear/error.h"

#include <stdint.h>

typedef struct sandbox_limits {
    int64_t memory_bytes; /* address space */
    int64_t cpu_seconds;
    int64_t file_bytes; /* largest unpacked file */
} sandbox_limits;

/* What holds; the first two always do. */
enum sandbox_guard {
    SANDBOX_SECCOMP = 1,    /* system calls, and their arguments */
    SANDBOX_UNDUMPABLE = 2, /* no core, and nobody but root looks into it */
    SANDBOX_LANDLOCK = 4,   /* no files, once more: where the kernel has it */
    SANDBOX_NAMESPACES = 8  /* it sees no other process: where the system lets it have its own */
};

/* Enter it, for good: resource limits, no new privileges, and the guards that there are, into
 * *guards. Of namespaces see sandbox_unshare. */
int sandbox_enter(const sandbox_limits *limits, unsigned *guards, shear_error *err);

/* Before it, on the only thread: go on in user and process namespaces of its own, where the system
 * allows that (a unit with RestrictNamespaces=yes does not): as their process 1, a child of the
 * process that was started, which waits for it and ends as it does. */
void sandbox_unshare(unsigned *guards);

#endif
