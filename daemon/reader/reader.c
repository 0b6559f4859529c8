/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "reader/reader.h"

#include "base/cleanup.h"
#include "reader/child_process.h"
#include "reader/child_stderr.h"
#include "reader/exchange.h"
#include "reader/launch.h"
#include "reader/validate.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

/* Create the memory, the socket and the pipe, and start the child with their other ends. Return 0
 * or errno. */
static int launch(reader *r, const shear_input *input, const int *fds,
                  const reader_limits *limits) {
    int sockets[2] = {-1, -1};
    int pipe[2];
    r->memory_fd = memfd_create("sheard-stamps", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    if (r->memory_fd < 0 || socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets) != 0)
        return errno;
    int rc = child_stderr_pipe(pipe);
    r->socket = sockets[0];
    r->child_stderr = pipe[0];
    if (rc == 0) {
        const launch_ends ends = {sockets[1], r->memory_fd, pipe[1], r->scratch.fds};
        rc = launch_reader(&r->pid, input, fds, ends, limits);
    }
    release_fd(&sockets[1]);
    release_fd(&pipe[1]);
    return rc;
}

/* Read the descriptions of carried columns, and check that they are those of the rows. */
static int read_carried(reader *r, shear_error *err) {
    static const char what[] = "describe the catalog's columns";
    int bytes = 0;
    r->carried = calloc((size_t)r->info.n_carried + 1, sizeof *r->carried);
    if (r->carried == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a catalog's columns");
    for (int i = 0; i < r->info.n_carried; i++) {
        const reader_request request = {.op = READER_CARRIED, .first = i};
        reader_reply reply;
        TRY(exchange_ask(r, &request, what, &reply, err));
        if (!validate_carried(&reply.carried))
            return exchange_give_up(r, READER_E_PROTOCOL, what, err);
        r->carried[i] = reply.carried;
        bytes += reply.carried.bytes;
    }
    r->info.carried = r->carried;
    return bytes == r->info.carried_bytes ? SHEAR_OK
                                          : exchange_give_up(r, READER_E_PROTOCOL, what, err);
}

static int open_field(reader *r, shear_error *err) {
    static const char what[] = "open the file";
    const reader_request request = {.op = READER_OPEN};
    reader_reply reply;
    TRY(exchange_ask(r, &request, what, &reply, err));
    if (!validate_info(&reply.info))
        return exchange_give_up(r, READER_E_PROTOCOL, what, err);
    r->info = reply.info;
    r->guards = reply.guards;
    return read_carried(r, err);
}

CLEANUP_DEFINE(reader, reader_stop)

int reader_start(reader **out, const shear_input *input, const int *fds,
                 const reader_limits *limits, shear_error *err) {
    CLEANUP(reader_release) reader *r = calloc(1, sizeof *r);
    *out = NULL;
    if (r == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a reader");
    *r = (reader){.socket = -1,
                  .memory_fd = -1,
                  .child_stderr = -1,
                  .timeout_ms = limits->timeout_ms,
                  .stop = limits->stop,
                  .shared_bytes = limits->shared_bytes};
    scratch_open(&r->scratch, limits->scratch, limits->scratch_bytes, limits->scratch_used,
                 input->path != NULL ? 1 : SHEAR_N_PARTS);
    const int rc = launch(r, input, fds, limits);
    if (rc != 0) {
        return shear_fail(err, SHEAR_E_IO, "is sheard-reader installed beside sheard?",
                          "the reader '%s' does not start: %s", limits->program, strerror(rc));
    }
    TRY(open_field(r, err));
    *out = CLEANUP_TAKE(r);
    return SHEAR_OK;
}

void reader_stop(reader *r) {
    if (r == NULL)
        return;
    release_fd(&r->socket);
    release_fd(&r->child_stderr);
    child_process_reap(&r->pid, true, NULL, 0);
    if (r->memory != NULL)
        munmap(r->memory, r->memory_bytes);
    release_fd(&r->memory_fd);
    scratch_close(&r->scratch);
    free(r->models);
    free(r->samples);
    free(r->carried);
    free(r->blocks);
    free(r);
}

const shear_field_info *reader_get_info(const reader *r) {
    return &r->info;
}

unsigned reader_get_guards(const reader *r) {
    return r->guards;
}

int reader_checksum(reader *r, char out[SHEAR_CHECKSUM_SIZE], atomic_llong *hashed,
                    shear_error *err) {
    static const char what[] = "read the whole file";
    const reader_request request = {.op = READER_HASH};
    reader_reply reply = {.hashed = 0};
    for (int64_t before = 0;; before = reply.hashed) {
        TRY(exchange_ask(r, &request, what, &reply, err));
        const bool done = reply.checksum[0] != '\0';
        if (done ? !validate_checksum(reply.checksum) : reply.hashed <= before)
            return exchange_give_up(r, READER_E_PROTOCOL, what, err);
        if (hashed != NULL)
            atomic_store(hashed, reply.hashed);
        if (done) {
            memcpy(out, reply.checksum, SHEAR_CHECKSUM_SIZE);
            return SHEAR_OK;
        }
        if (exchange_is_stopping(r))
            return exchange_give_up(r, READER_E_STOPPED, what, err);
    }
}

/* Set the size of the shared memory, and seal it: a child that shrank it would crash the daemon. */
static int make_memory(reader *r, shear_error *err) {
    const bool sized =
        ftruncate(r->memory_fd, (off_t)r->memory_bytes) == 0 &&
        fcntl(r->memory_fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) == 0;
    void *memory =
        sized ? mmap(NULL, r->memory_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, r->memory_fd, 0)
              : MAP_FAILED;
    if (memory == MAP_FAILED) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "no shared memory of %zu bytes: %s",
                          r->memory_bytes, strerror(errno));
    }
    r->memory = memory;
    return SHEAR_OK;
}

int reader_map(reader *r, int slots, int capacity, shear_error *err) {
    assert(r->memory == NULL);
    r->slots = slots;
    r->capacity = capacity;
    r->psf_bytes = shear_psf_bytes(&r->info);
    r->slot_bytes = shear_block_bytes(&r->info, capacity);
    r->memory_bytes = r->psf_bytes + (size_t)slots * r->slot_bytes;
    if (r->memory_bytes > (size_t)r->shared_bytes) {
        return shear_fail(
            err, READER_E_MEMORY,
            "raise [reader] shared_memory, cut smaller stamps and PSFs, or carry fewer columns",
            "%d blocks of %d stamp pairs take %zu bytes of shared memory, allowed are %" PRId64,
            slots, capacity, r->memory_bytes, r->shared_bytes);
    }
    TRY(make_memory(r, err));
    r->blocks = calloc((size_t)slots, sizeof *r->blocks);
    if (r->blocks == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %d blocks", slots);
    const reader_request request = {.op = READER_MAP,
                                    .slots = slots,
                                    .capacity = capacity,
                                    .slot_bytes = (int64_t)r->slot_bytes,
                                    .psf_bytes = (int64_t)r->psf_bytes};
    reader_reply reply;
    return exchange_ask(r, &request, "share memory", &reply, err);
}

int64_t reader_shared_bytes(const reader *r) {
    return (int64_t)r->memory_bytes;
}

int reader_read_psf(reader *r, int64_t index, const double **psf, shear_error *err) {
    const reader_request request = {.op = READER_PSF, .first = index};
    reader_reply reply;
    *psf = (const double *)(void *)r->memory;
    return exchange_ask(r, &request, "read a PSF", &reply, err);
}

static int read_block(reader *r, uint32_t op, int slot, int64_t first, int count,
                      const shear_block **block, shear_error *err) {
    const reader_request request = {.op = op, .slot = slot, .first = first, .count = count};
    reader_reply reply;
    assert(slot >= 0 && slot < r->slots && count >= 0 && count <= r->capacity);
    shear_block *b = &r->blocks[slot];
    /* The views are computed on this side, so nothing that the child writes is used as a pointer or
     * a size. */
    shear_block_place(b, &r->info, r->capacity,
                      r->memory + r->psf_bytes + (size_t)slot * r->slot_bytes);
    const int code = exchange_ask(r, &request, "read stamps", &reply, err);
    b->stamps.first = first;
    b->stamps.count = count;
    b->stamps.n_psf = reply.n_psf;
    *block = b;
    if (code != SHEAR_OK)
        return code;
    return reply.n_psf >= 0 && reply.n_psf <= count
               ? SHEAR_OK
               : exchange_give_up(r, READER_E_PROTOCOL, "read stamps", err);
}

int reader_read(void *self, int slot, int64_t first, int count, const shear_block **block,
                shear_error *err) {
    return read_block(self, READER_STAMPS, slot, first, count, block, err);
}

int reader_read_columns(reader *r, int64_t stamp, const shear_block **block, shear_error *err) {
    return read_block(r, READER_COLUMNS, 0, stamp, 1, block, err);
}
