/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/internal.h: the daemon's side of a reader child. */
#ifndef SHEARD_READER_INTERNAL_H
#define SHEARD_READER_INTERNAL_H

#include "reader/reader.h"
#include "reader/scratch.h"

#include <sys/types.h>

struct reader {
    pid_t pid; /* 0 once reaped */
    int socket;
    int memory_fd;
    int child_stderr; /* what it writes there: child_stderr.h */
    int timeout_ms;
    const atomic_bool *stop;
    int64_t shared_bytes;
    int failed; /* enum reader_code after the first failure of the child itself */
    shear_error failure;
    shear_field_info info;
    unsigned guards;
    scratch scratch;
    char *memory;
    size_t memory_bytes, psf_bytes, slot_bytes;
    int slots, capacity;
    shear_block *blocks; /* [slots] views into memory */
};

#endif
