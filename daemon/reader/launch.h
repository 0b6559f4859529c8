/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/launch.h: start the reader child with the descriptors that it needs, and no others. */
#pragma once

#include "reader/reader.h"

#include <sys/types.h>

/* The descriptors that the child inherits beside its files; the caller keeps its own. */
typedef struct launch_ends {
    int socket;         /* the child's end of the socket pair */
    int memory;         /* the shared memory */
    int child_stderr;   /* becomes its standard error (reader/child_stderr.h) */
    const int *scratch; /* [SHEAR_N_PARTS], ends at the first -1 (reader/scratch.h) */
} launch_ends;

/* Start sheard-reader on these files (see reader_start). Return 0 or errno. */
int launch_reader(pid_t *pid, const shear_input *input, const int *fds, launch_ends ends,
                  const reader_limits *limits);
