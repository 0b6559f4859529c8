/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/reader.h: start the sandboxed child that reads a job's files, and request hashes, PSFs and
 * stamps from it.
 *
 * A reader is used by one thread at a time. Every call waits a limited time for each reply of the
 * child. A child that dies, hangs or sends an invalid reply is killed. That call and every later
 * one then fail with a code of enum reader_code, which the service treats as a bug of the reader,
 * not as a fault of the file's data. */
#pragma once

#include "shear/error.h"
#include "shear/field.h"
#include "shear/input.h"

#include <stdatomic.h>
#include <stdint.h>

enum reader_code {
    READER_E_DIED = 100,     /* the child ended: a crash, or the limit of processor time */
    READER_E_HUNG = 101,     /* no reply in time */
    READER_E_PROTOCOL = 102, /* an invalid reply */
    READER_E_MEMORY = 103,   /* the file needs more memory than its reader may have */
    READER_E_STOPPED = 104   /* the caller requested a stop before the reply */
};

typedef struct reader_limits {
    const char *program;        /* path of sheard-reader */
    const char *scratch;        /* directory for unpacked copies: reader/scratch.h */
    int64_t scratch_bytes;      /* limit of unpacked copies, of all readers together ... */
    atomic_llong *scratch_used; /* ... whose bytes are counted here; may be NULL */
    int64_t memory_bytes;       /* limit of the child's address space; 0: unlimited */
    int64_t cpu_seconds;        /* limit of the child's processor time; 0: unlimited */
    int64_t unpacked_bytes;     /* largest unpacked .gz file */
    int64_t shared_bytes;       /* largest shared memory */
    int timeout_ms;             /* limit of the time for one reply */
    /* Any thread may set it to true: the current call then returns within a second. May be NULL. */
    const atomic_bool *stop;
} reader_limits;

typedef struct reader reader;

/* Start a child on the files of `input`, and have it open the field. The descriptors `fds`, as for
 * shear_field_open_input, are duplicated. Errors are those of shear_field_open_input or of enum
 * reader_code; *r is NULL then. */
int reader_start(reader **r, const shear_input *input, const int *fds, const reader_limits *limits,
                 shear_error *err);
/* Kill and reap the child, and free the reader. NULL is accepted. */
void reader_stop(reader *r);

/* Return the field's description, already checked; it is the reader's. */
const shear_field_info *reader_get_info(const reader *r);
/* Return the guards of its sandbox as the child reports them: enum sandbox_guard. */
unsigned reader_get_guards(const reader *r);

/* Compute the content's hash (shear_input_checksum) in the child. The child works in slices, so
 * that this may take any time and be stopped. *hashed receives the bytes hashed so far, for other
 * threads; it may be NULL. */
int reader_checksum(reader *r, char out[SHEAR_CHECKSUM_SIZE], atomic_llong *hashed,
                    shear_error *err);

/* Create shared memory for `slots` blocks of at most `capacity` stamp pairs. Call it once, before
 * the functions below. */
int reader_map(reader *r, int slots, int capacity, shear_error *err);
/* Return the bytes of the shared memory. */
int64_t reader_shared_bytes(const reader *r);
/* Read PSF image `index`. *psf [psf_ny][psf_nx] is valid until the next call. */
int reader_read_psf(reader *r, int64_t index, const double **psf, shear_error *err);
/* Read all PSF models of the field: *models [info.n_models] is the reader's. READER_E_MEMORY if
 * they take more than the limit of shared memory. */
int reader_read_models(reader *r, const shear_psf_model **models, shear_error *err);
/* Read stamp pairs [first, first+count) into `slot`. *block is valid until the slot is read again.
 * This is a read function of shear_source. */
int reader_read(void *r, int slot, int64_t first, int count, const shear_block **block,
                shear_error *err);
/* Read the columns of one stamp, without pixels. *block is valid until slot 0 is read. */
int reader_read_columns(reader *r, int64_t stamp, const shear_block **block, shear_error *err);
