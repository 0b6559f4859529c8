/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/wire.h: the messages between the daemon and its reader child, over a SOCK_SEQPACKET
 * pair: one request, one reply, each a whole struct (both ends are of one build). Stamps do not
 * travel here: they lie in shared memory.
 *
 * The daemon trusts nothing that comes back: every number is checked before use (reader.c). */
#ifndef SHEARD_READER_WIRE_H
#define SHEARD_READER_WIRE_H

#include "shear/error.h"
#include "shear/field.h"

#include <stdint.h>

/* Descriptors of the child, fixed by the daemon before exec: a field file, or each part that there
 * is at READER_FD_FILE + enum shear_part. */
enum {
    READER_FD_SOCKET = 3,
    READER_FD_MEMORY = 4,
    READER_FD_FILE = 5,
    READER_FD_SCRATCH = READER_FD_FILE + SHEAR_N_PARTS, /* to unpack into */
    READER_FD_END = READER_FD_SCRATCH + SHEAR_N_PARTS
};

/* Arguments of the child: memory, processor seconds, largest unpacked file, number of scratch
 * files; then the file's name; or, for each part, its file's name ("" where it is not given), its
 * HDU's number
 * (-1: none) and its HDU's name ("": none). Counted with argv[0]. */
enum {
    READER_ARG_FIRST_NAME = 5,
    READER_ARGS_FILE = READER_ARG_FIRST_NAME + 1,
    READER_ARGS_PARTS = READER_ARG_FIRST_NAME + 3 * SHEAR_N_PARTS
};

enum { READER_WIRE_VERSION = 3 };

enum reader_op {
    READER_OPEN = 1, /* -> info */
    READER_MAP,      /* slots, capacity, slot_bytes: the shared memory has been sized for them */
    READER_PSF,      /* image `first` into the PSF area */
    READER_STAMPS,   /* pairs [first, first+count) into slot */
    READER_HASH      /* some more of the content -> hashed; the checksum when all is */
};

typedef struct reader_request {
    uint32_t version;
    uint32_t op;
    int32_t slot, count;
    int64_t first;
    int64_t slots, capacity, slot_bytes, psf_bytes; /* READER_MAP */
} reader_request;

typedef struct reader_reply {
    uint32_t version;
    uint32_t op;
    uint32_t guards;                    /* READER_OPEN: enum sandbox_guard */
    int32_t code;                       /* enum shear_code */
    int32_t n_psf;                      /* READER_STAMPS: images in the slot */
    int64_t hashed;                     /* READER_HASH: bytes so far */
    char checksum[SHEAR_CHECKSUM_SIZE]; /* READER_HASH: of all; "": there is more to read */
    shear_error error;                  /* where code is not 0 */
    shear_field_info info;              /* READER_OPEN */
} reader_reply;

#endif
