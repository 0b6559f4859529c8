/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/reader.h: the daemon's side of a reader child: start it on open files, ask it for
 * stamps, outlive it.
 *
 * A reader is used by one thread at a time. Every call waits for the child at most the time it was
 * given; a child that dies, hangs or answers nonsense is killed, and the call (and every later one)
 * fails with a code of its own, which the service treats as a bug of the reader, not as a fault of
 * the file's data. */
#ifndef SHEARD_READER_H
#define SHEARD_READER_H

#include "shear/error.h"
#include "shear/field.h"
#include "shear/input.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

enum reader_code {
    READER_E_DIED = 100,     /* the child ended: a crash, or a limit on processor time */
    READER_E_HUNG = 101,     /* no answer in time */
    READER_E_PROTOCOL = 102, /* an answer that makes no sense */
    READER_E_MEMORY = 103,   /* the file needs more memory than its reader may have */
    READER_E_STOPPED = 104   /* not done yet when the caller was to stop */
};

typedef struct reader_limits {
    const char *program;        /* path of sheard-reader */
    const char *scratch;        /* directory for unpacked copies: reader/scratch.h */
    int64_t scratch_bytes;      /* of all readers together ... */
    atomic_llong *scratch_used; /* ... which is counted here; may be NULL */
    int64_t memory_bytes;       /* of the child's address space; 0 = unlimited */
    int64_t cpu_seconds;        /* of the child in all; 0 = unlimited */
    int64_t unpacked_bytes;     /* largest unpacked .gz */
    int64_t shared_bytes;       /* largest shared memory */
    int timeout_ms;             /* of one answer */
    /* Where this becomes true (in any thread), the call under way returns within a second. May be
     * NULL. */
    const atomic_bool *stop;
} reader_limits;

typedef struct reader reader;

/* Start a child on the files of `input`, open for reading as `fds` (as of shear_field_open_input;
 * duplicated), and let it open the field. Errors are those of shear_field_open_input, or enum
 * reader_code. *r is NULL on error. */
int reader_start(reader **r, const shear_input *input, const int *fds, const reader_limits *limits,
                 shear_error *err);
/* Ask it to end, or kill it, and reap it. NULL is accepted. */
void reader_stop(reader *r);

const shear_field_info *reader_get_info(const reader *r);
/* What the child says that keeps it in: enum sandbox_guard. */
unsigned reader_get_guards(const reader *r);

/* The content's hash (shear_input_checksum), which the child reads; in slices, so that it may take
 * as long as it has to, and be stopped. *hashed, where not NULL: bytes so far, for others to watch.
 */
int reader_checksum(reader *r, char out[SHEAR_CHECKSUM_SIZE], atomic_llong *hashed,
                    shear_error *err);

/* Share memory for `slots` blocks of at most `capacity` pairs. Once, before the calls below. */
int reader_map(reader *r, int slots, int capacity, shear_error *err);
/* What it shares then. */
int64_t reader_shared_bytes(const reader *r);
/* PSF image `index`; *psf [psf_ny][psf_nx] is valid until the next call. */
int reader_read_psf(reader *r, int64_t index, const double **psf, shear_error *err);
/* Pairs [first, first+count) into `slot`; *block is valid until the slot is read again. The form of
 * shear_source.read. */
int reader_read(void *r, int slot, int64_t first, int count, const shear_block **block,
                shear_error *err);

#endif
