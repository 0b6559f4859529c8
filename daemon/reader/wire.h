/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/wire.h: the messages between the daemon and its reader child, over a SOCK_SEQPACKET socket
 * pair. Each request and reply is a whole struct, as both programs are of one build. Stamps are not
 * sent: they are in shared memory.
 *
 * The daemon does not trust replies: every number is checked before it is used (exchange.c,
 * validate.c). */
#pragma once

#include "shear/error.h"
#include "shear/field.h"

#include <stdint.h>

/* Descriptors of the child, set by the daemon before exec. A field file is at READER_FD_FILE, a
 * part at READER_FD_FILE + enum shear_part. */
enum {
    READER_FD_SOCKET = 3,
    READER_FD_MEMORY = 4,
    READER_FD_FILE = 5,
    READER_FD_SCRATCH = READER_FD_FILE + SHEAR_N_PARTS, /* temporary files for unpacking */
    READER_FD_END = READER_FD_SCRATCH + SHEAR_N_PARTS
};

/* Arguments of the child: bytes of memory, seconds of processor time, bytes of the largest unpacked
 * file, number of scratch files, columns, rows and number of stamps (shear_mosaic). Then the file's
 * name; or, for each part, its file's name ("": not given), its HDU's number (-1: none) and its
 * HDU's name ("": none), and the options of an exposure (shear_exposure_option; "": the default).
 * The numbers include argv[0]. */
enum {
    READER_ARG_FIRST_NAME = 8,
    READER_ARGS_FILE = READER_ARG_FIRST_NAME + 1,
    READER_ARG_FIRST_OPTION = READER_ARG_FIRST_NAME + 3 * SHEAR_N_PARTS,
    READER_ARGS_PARTS = READER_ARG_FIRST_OPTION + SHEAR_N_EXPOSURE_OPTIONS
};

enum { READER_WIRE_VERSION = 5 };

enum reader_op {
    READER_OPEN = 1, /* open the field: -> info */
    READER_MAP,      /* map the shared memory, which has been sized for these numbers */
    READER_MODEL,    /* describe PSF model `first` -> model, without its samples */
    READER_CARRIED,  /* describe carried column `first` -> carried */
    READER_PSF,      /* read PSF image `first` into the PSF area */
    READER_STAMPS,   /* read stamp pairs [first, first+count) into slot */
    READER_COLUMNS,  /* the same without pixels, into slot 0 */
    READER_HASH      /* hash some more of the content -> hashed; at its end also checksum */
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
    int32_t n_psf;                      /* READER_STAMPS: PSF images in the slot */
    int64_t hashed;                     /* READER_HASH: bytes so far */
    char checksum[SHEAR_CHECKSUM_SIZE]; /* READER_HASH: of the whole content; "": there is more to
                                           read */
    shear_error error;                  /* if code is not 0 */
    shear_field_info info;              /* READER_OPEN */
    shear_psf_model model;              /* READER_MODEL */
    shear_carried carried;              /* READER_CARRIED */
} reader_reply;
