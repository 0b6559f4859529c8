/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard-reader: the child that reads one FITS file for the daemon. All of CFITSIO that ever sees a
 * stranger's bytes runs here, sandboxed before the first of them is read. Descriptors:
 * reader/wire.h. Arguments: the file's name (for messages), memory, processor seconds, largest
 * unpacked file, scratch directory. */
#include "reader/sandbox.h"
#include "reader/wire.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

typedef struct child {
    const char *name;
    shear_field *field;
    char *memory; /* PSF area, then slots */
    size_t memory_bytes;
    reader_request map; /* the sizes that the daemon chose */
} child;

static int do_open(child *c, reader_reply *reply, shear_error *err) {
    if (c->field != NULL) {
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "the reader has a file already");
    }
    const int code = shear_field_open_fd(&c->field, READER_FD_FILE, c->name, err);
    if (code == SHEAR_OK) {
        reply->info = *shear_field_get_info(c->field);
    }
    return code;
}

static int do_map(child *c, const reader_request *r, shear_error *err) {
    c->map = *r;
    c->memory_bytes = (size_t)(r->psf_bytes + r->slots * r->slot_bytes);
    c->memory =
        mmap(NULL, c->memory_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, READER_FD_MEMORY, 0);
    if (c->memory == MAP_FAILED) {
        c->memory = NULL;
        return shear_fail(err, SHEAR_E_NOMEM, "allow the reader more memory ([reader] memory)",
                          "the reader cannot map %zu bytes: %s", c->memory_bytes, strerror(errno));
    }
    return SHEAR_OK;
}

static int do_stamps(child *c, const reader_request *r, reader_reply *reply, shear_error *err) {
    shear_block block;
    shear_block_place(&block, shear_field_get_info(c->field), (int)c->map.capacity,
                      c->memory + c->map.psf_bytes + r->slot * c->map.slot_bytes);
    const int code = shear_field_read(c->field, r->first, r->count, &block, err);
    reply->n_psf = block.stamps.n_psf;
    return code;
}

static int answer(child *c, const reader_request *r, reader_reply *reply) {
    shear_error *err = &reply->error;
    switch (r->op) {
    case READER_OPEN:
        return do_open(c, reply, err);
    case READER_MAP:
        return do_map(c, r, err);
    case READER_PSF:
        return shear_field_read_psf(c->field, r->first, (double *)(void *)c->memory, err);
    case READER_STAMPS:
        return do_stamps(c, r, reply, err);
    default:
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "the reader knows no request %u", r->op);
    }
}

static int serve(child *c) {
    reader_request request;
    for (;;) {
        const ssize_t got = recv(READER_FD_SOCKET, &request, sizeof request, 0);
        if (got == 0 || (got < 0 && errno != EINTR)) {
            return 0; /* the daemon is done with us */
        }
        if (got != (ssize_t)sizeof request || request.version != READER_WIRE_VERSION) {
            continue;
        }
        reader_reply reply = {.version = READER_WIRE_VERSION, .op = request.op};
        reply.code = answer(c, &request, &reply);
        if (send(READER_FD_SOCKET, &reply, sizeof reply, MSG_NOSIGNAL) != (ssize_t)sizeof reply) {
            return 1;
        }
    }
}

int main(int argc, char **argv) {
    if (argc != 6) {
        fprintf(stderr, "sheard-reader is started by sheard, not by hand\n");
        return 2;
    }
    const sandbox_limits limits = {.memory_bytes = strtoll(argv[2], NULL, 10),
                                   .cpu_seconds = strtoll(argv[3], NULL, 10),
                                   .file_bytes = strtoll(argv[4], NULL, 10)};
    child c = {.name = argv[1]};
    int landlocked = 0;
    shear_error err = {0};
    /* Whatever else the daemon may have been started with is none of the reader's business. */
    close_range(READER_FD_MEMORY + 1, ~0U, 0);
    setenv("TMPDIR", argv[5], 1);
    setenv("SHEAR_UNPACK_LIMIT", argv[4], 1);
    if (sandbox_enter(&limits, READER_FD_FILE, argv[5], &landlocked, &err) != SHEAR_OK) {
        const reader_reply reply = {
            .version = READER_WIRE_VERSION, .op = READER_OPEN, .code = err.code, .error = err};
        send(READER_FD_SOCKET, &reply, sizeof reply, MSG_NOSIGNAL);
        return 1;
    }
    return serve(&c);
}
