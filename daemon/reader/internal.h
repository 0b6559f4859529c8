/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/internal.h: the state of a reader, on the daemon's side. */
#pragma once

#include "reader/reader.h"
#include "reader/scratch.h"

#include <sys/types.h>

struct reader {
    pid_t pid; /* 0 once reaped */
    int socket;
    int memory_fd;
    int child_stderr; /* read end of the child's standard error: child_stderr.h */
    int timeout_ms;
    const atomic_bool *stop;
    int64_t shared_bytes;
    int failed; /* code of the first failure of the child itself, returned by all later calls; 0:
                   none */
    shear_error failure;
    shear_field_info info;
    unsigned guards;
    scratch scratch;
    char *memory;
    size_t memory_bytes, psf_bytes, slot_bytes;
    int slots, capacity;
    shear_psf_model *models; /* [info.n_models] once they have been read */
    double *samples;         /* of all models */
    shear_carried *carried;  /* [info.n_carried] */
    shear_block *blocks;     /* [slots] views into the shared memory */
};
