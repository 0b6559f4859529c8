/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/sandbox.h: restrict what the reader child may do: read and write open files, allocate
 * memory, answer on its socket, and end. It cannot open files, no call takes a path or another
 * process, and no new memory is executable. */
#pragma once

#include "shear/error.h"

#include <stdint.h>

typedef struct sandbox_limits {
    int64_t memory_bytes; /* of address space; 0: unlimited */
    int64_t cpu_seconds;
    int64_t file_bytes; /* largest unpacked file */
} sandbox_limits;

/* The guards in force. The first two always are. */
enum sandbox_guard {
    SANDBOX_SECCOMP = 1,    /* filter of system calls and their arguments */
    SANDBOX_UNDUMPABLE = 2, /* no core file, and only root may inspect the process */
    SANDBOX_LANDLOCK = 4,   /* no access to files by path, if the kernel has Landlock */
    SANDBOX_NAMESPACES = 8  /* namespaces without other processes, if the system allows them */
};

/* Enter the sandbox, for good: resource limits, no new privileges, and the guards that are
 * available, which are added to *guards. For namespaces see sandbox_unshare. */
int sandbox_enter(const sandbox_limits *limits, unsigned *guards, shear_error *err);

/* Continue in new user and process namespaces, if the system allows that (a unit with
 * RestrictNamespaces=yes does not). Call it before sandbox_enter, while there is one thread. The
 * caller goes on as process 1 of the namespaces, a child of the original process, which waits for
 * it and ends as it does. */
void sandbox_unshare(unsigned *guards);
