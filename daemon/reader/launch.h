/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/launch.h: starting the reader child with what it is to have, and nothing else. */
#ifndef SHEARD_READER_LAUNCH_H
#define SHEARD_READER_LAUNCH_H

#include "reader/reader.h"

#include <sys/types.h>

/* What the child gets of the daemon's; all of it stays the caller's. */
typedef struct launch_ends {
    int socket;         /* its end of the pair */
    int memory;         /* shared */
    int child_stderr;   /* its standard error (reader/child_stderr.h) */
    const int *scratch; /* [SHEAR_N_PARTS], the first -1 ends them (reader/scratch.h) */
} launch_ends;

/* Start sheard-reader on these files (see reader_start). Returns 0 or errno. */
int launch_reader(pid_t *pid, const shear_input *input, const int *fds, launch_ends ends,
                  const reader_limits *limits);

#endif
