/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program sheard-reader: read the FITS files of one job for the daemon. CFITSIO sees the bytes
 * of untrusted files only here, after the sandbox has been entered. For descriptors and arguments
 * see reader/wire.h. */
#include "base/clock.h"

#include "base/cleanup.h"
#include "reader/sandbox.h"
#include "reader/wire.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

typedef struct child {
    shear_input input;
    int fds[SHEAR_N_PARTS]; /* -1: none */
    unsigned guards;        /* enum sandbox_guard */
    shear_field *field;
    shear_hashing *hashing;
    char *memory; /* shared: the PSF area, then the slots */
    size_t memory_bytes;
    reader_request map; /* the sizes that the daemon has set */
} child;

static int do_open(child *c, reader_reply *reply, shear_error *err) {
    if (c->field != NULL)
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "the reader has a file already");
    TRY(shear_field_open_input(&c->field, &c->input, c->fds, err));
    reply->info = *shear_field_get_info(c->field);
    reply->info.carried = NULL;
    reply->guards = c->guards;
    return SHEAR_OK;
}

static int do_model(child *c, const reader_request *r, reader_reply *reply, shear_error *err) {
    const shear_psf_model *models = NULL;
    if (r->first < 0 || r->first >= shear_field_get_models(c->field, &models))
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "there is no such PSF model");
    reply->model = models[r->first];
    reply->model.samples = NULL;
    return SHEAR_OK;
}

static int do_carried(child *c, const reader_request *r, reader_reply *reply, shear_error *err) {
    const shear_field_info *info = shear_field_get_info(c->field);
    if (r->first < 0 || r->first >= info->n_carried)
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "there is no such carried column");
    reply->carried = info->carried[r->first];
    return SHEAR_OK;
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
    const int code = (r->op == READER_COLUMNS ? shear_field_read_columns : shear_field_read)(
        c->field, r->first, r->count, &block, err);
    reply->n_psf = block.stamps.n_psf;
    return code;
}

/* Hash the next part of the content, for a limited time: in between, the daemon may stop, and show
 * the progress. */
static int do_hash(child *c, reader_reply *reply, shear_error *err) {
    enum { STEP = 1 << 20, STEPS = 256, SLICE_MS = 250 };
    const int64_t end_ms = clock_ms(CLOCK_MONOTONIC) + SLICE_MS;
    bool done = false;
    if (c->hashing == NULL) {
        TRY(shear_hashing_new(&c->hashing, &c->input, c->fds, shear_field_get_info(c->field), err));
    }
    for (int i = 0; !done && i < STEPS && (i == 0 || clock_ms(CLOCK_MONOTONIC) < end_ms); i++)
        TRY(shear_hashing_step(c->hashing, STEP, &done, err));
    reply->hashed = shear_hashing_bytes(c->hashing);
    if (done) {
        shear_hashing_text(c->hashing, reply->checksum);
        shear_hashing_free(c->hashing);
        c->hashing = NULL;
    }
    return SHEAR_OK;
}

static int answer(child *c, const reader_request *r, reader_reply *reply) {
    shear_error *err = &reply->error;
    switch (r->op) {
    case READER_OPEN:
        return do_open(c, reply, err);
    case READER_MAP:
        return do_map(c, r, err);
    case READER_MODEL:
        return do_model(c, r, reply, err);
    case READER_CARRIED:
        return do_carried(c, r, reply, err);
    case READER_PSF:
        return shear_field_read_psf(c->field, r->first, (double *)(void *)c->memory, err);
    case READER_STAMPS:
    case READER_COLUMNS:
        return do_stamps(c, r, reply, err);
    case READER_HASH:
        return do_hash(c, reply, err);
    default:
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "the reader got an unknown request %u",
                          r->op);
    }
}

static int serve(child *c) {
    reader_request request;
    for (;;) {
        const ssize_t got = recv(READER_FD_SOCKET, &request, sizeof request, 0);
        if (got == 0 || (got < 0 && errno != EINTR)) {
            return 0; /* the daemon has closed the socket */
        }
        if (got != (ssize_t)sizeof request || request.version != READER_WIRE_VERSION)
            continue;
        reader_reply reply = {.version = READER_WIRE_VERSION, .op = request.op};
        reply.code = answer(c, &request, &reply);
        if (send(READER_FD_SOCKET, &reply, sizeof reply, MSG_NOSIGNAL) != (ssize_t)sizeof reply)
            return 1;
    }
}

/* Read the names, which are for messages, and set the descriptors. */
static void read_input(child *c, int argc, char **argv) {
    c->input = shear_input_of_file(argc == READER_ARGS_FILE ? argv[READER_ARG_FIRST_NAME] : NULL);
    c->input.mosaic = (shear_mosaic){.stamp_nx = (int)strtol(argv[5], NULL, 10),
                                     .stamp_ny = (int)strtol(argv[6], NULL, 10),
                                     .stamps = strtoll(argv[7], NULL, 10)};
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        char *const *part = argv + READER_ARG_FIRST_NAME + (ptrdiff_t)3 * i;
        const bool whole = c->input.path != NULL;
        const bool given = whole ? i == 0 : part[0][0] != '\0';
        c->fds[i] = given ? READER_FD_FILE + i : -1;
        if (given && !whole) {
            c->input.parts[i] = (shear_input_part){.path = part[0],
                                                   .hdu = strtoll(part[1], NULL, 10),
                                                   .extname = part[2][0] != '\0' ? part[2] : NULL};
        } else if (!given) {
            close(READER_FD_FILE + i); /* a descriptor that the daemon may have inherited */
        }
    }
    for (int i = 0; i < SHEAR_N_EXPOSURE_OPTIONS && c->input.path == NULL; i++) {
        const char *text = argv[READER_ARG_FIRST_OPTION + i];
        if (text[0] != '\0') /* the daemon has checked it */
            (void)shear_exposure_set(&c->input.exposure, shear_exposure_option(i), text, NULL);
    }
    if (shear_input_is_exposure(&c->input) && c->fds[SHEAR_PART_NOISE] >= 0)
        c->input.exposure.noise = SHEAR_NOISE_IMAGE;
}

int main(int argc, char **argv) {
    if (argc != READER_ARGS_FILE && argc != READER_ARGS_PARTS) {
        fprintf(stderr, "sheard-reader is started by sheard, not by hand\n");
        return 2;
    }
    int scratch[SHEAR_N_PARTS];
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        scratch[i] = READER_FD_SCRATCH + i;
    const int n_scratch = (int)strtol(argv[4], NULL, 10);
    const sandbox_limits limits = {.memory_bytes = strtoll(argv[1], NULL, 10),
                                   .cpu_seconds = strtoll(argv[2], NULL, 10),
                                   .file_bytes = strtoll(argv[3], NULL, 10)};
    child c = {0};
    shear_error err = {0};
    read_input(&c, argc, argv);
    close_range(READER_FD_SCRATCH + (unsigned)n_scratch, ~0U, 0);
    shear_field_use_scratch(scratch, n_scratch);
    setenv("SHEAR_UNPACK_LIMIT", argv[3], 1);
    sandbox_unshare(&c.guards);
    if (sandbox_enter(&limits, &c.guards, &err) != SHEAR_OK) {
        const reader_reply reply = {
            .version = READER_WIRE_VERSION, .op = READER_OPEN, .code = err.code, .error = err};
        send(READER_FD_SOCKET, &reply, sizeof reply, MSG_NOSIGNAL);
        return 1;
    }
    return serve(&c);
}
