/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "reader/reader.h"

#include "reader/child_stderr.h"
#include "reader/launch.h"
#include "reader/scratch.h"
#include "reader/wire.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

struct reader {
    pid_t pid; /* 0 once reaped */
    int socket;
    int memory_fd;
    int said; /* what it writes to its standard error: reader/child_stderr.h */
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

/* ---- the child's life ---- */

static void describe_end(int status, char *out, size_t size) {
    if (WIFSIGNALED(status)) {
        snprintf(out, size, "it was killed by signal %d, %s", WTERMSIG(status),
                 strsignal(WTERMSIG(status)));
    } else {
        snprintf(out, size, "it ended with code %d", WEXITSTATUS(status));
    }
}

/* Reap the child; returns its exit code, -1 where it has none. A child whose socket is closed may
 * still be dying: it has a second before it is killed. */
static int reap(reader *r, bool kill_now, char *end, size_t size) {
    int status = 0;
    const struct timespec pause = {.tv_nsec = 5000000};
    pid_t got = 0;
    for (int i = 0; !kill_now && i < 200 && got == 0; i++) {
        got = waitpid(r->pid, &status, WNOHANG);
        if (got == 0) {
            nanosleep(&pause, NULL);
        }
    }
    if (got == 0) {
        kill(r->pid, SIGKILL);
    }
    /* Not for ever: what sleeps in a dead file server cannot be killed, and must hold up nobody. It
     * is left to the system. */
    for (int i = 0; i < 200 && got == 0; i++) {
        got = waitpid(r->pid, &status, WNOHANG);
        if (got == 0) {
            nanosleep(&pause, NULL);
        }
    }
    r->pid = 0;
    if (got > 0) {
        describe_end(status, end, size);
    } else {
        snprintf(end, size, "nothing is known of its end");
    }
    return got > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* Exit codes of the dynamic linker, and of a shell, for a program that never came to its first
 * line. */
static bool never_started(int exit_code) {
    return exit_code == 126 || exit_code == 127;
}

/* What happened, for people, into why[]. Returns the code that it is to have. */
static int find_reason(reader *r, int code, char *why, size_t size) {
    char end[160] = "it is gone";
    char said[240] = "";
    const int exit_code = r->pid > 0 ? reap(r, code != READER_E_DIED, end, sizeof end) : -1;
    last_words_read(r->said, said, sizeof said);
    snprintf(why, size, "%s%s%s",
             code == READER_E_HUNG       ? "no answer in time, it was stopped"
             : code == READER_E_STOPPED  ? "no answer yet when it was to stop"
             : code == READER_E_PROTOCOL ? "its answer made no sense, it was stopped"
                                         : end,
             said[0] != '\0' ? "; it said: " : "", said);
    return code == READER_E_DIED && never_started(exit_code) ? SHEAR_E_IO : code;
}

/* The child is of no more use: reap it, and remember why for this call and all later ones. */
static int give_up(reader *r, int code, const char *what, shear_error *err) {
    char why[420];
    r->failed = find_reason(r, code, why, sizeof why);
    shear_fail(&r->failure, r->failed,
               r->failed == SHEAR_E_IO
                   ? "install sheard again, with the libraries that it needs"
                   : "the file is damaged in a way that CFITSIO does not survive, or the limits in "
                     "section [reader] are too small for it",
               "the reader failed to %s: %s", what, why);
    if (err != NULL) {
        *err = r->failure;
    }
    return r->failed;
}

/* ---- questions and answers ---- */

static int64_t now_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000 + t.tv_nsec / 1000000;
}

static bool is_stopping(const reader *r) {
    return r->stop != NULL && atomic_load(r->stop);
}

/* SHEAR_OK when there is something to receive; READER_E_HUNG, READER_E_STOPPED; or, with an error,
 * that its unpacked copies cannot stay. */
static int wait_for_answer(reader *r, shear_error *err) {
    enum { LOOK_MS = 50, GRACE_MS = 700 };
    struct pollfd p = {.fd = r->socket, .events = POLLIN};
    int64_t end_ms = now_ms() + r->timeout_ms;
    bool stopping = false;
    for (;;) {
        const int64_t left_ms = end_ms - now_ms();
        const int ready = poll(&p, 1,
                               (int)(left_ms < 0         ? 0
                                     : left_ms < LOOK_MS ? left_ms
                                                         : LOOK_MS));
        if (ready > 0 || (ready < 0 && errno != EINTR)) {
            return SHEAR_OK; /* an error is recv's to tell */
        }
        const int code = scratch_check(&r->scratch, false, err);
        if (code != SHEAR_OK) {
            return code;
        }
        if (ready == 0 && left_ms <= LOOK_MS) {
            return stopping ? READER_E_STOPPED : READER_E_HUNG;
        }
        if (!stopping && is_stopping(r)) {
            stopping = true;
            end_ms = end_ms < now_ms() + GRACE_MS ? end_ms : now_ms() + GRACE_MS;
        }
    }
}

/* What the child says went wrong. That it is short of memory is told apart from the daemon's own
 * shortage. */
static int failed_answer(const reader_reply *reply, shear_error *err) {
    const bool memory = reply->code == SHEAR_E_NOMEM;
    const int code = memory ? READER_E_MEMORY : reply->code;
    if (err != NULL) {
        *err = reply->error;
        err->code = code;
        if (memory && err->advice[0] == '\0') {
            snprintf(err->advice, sizeof err->advice, "allow the reader more ([reader] memory)");
        }
    }
    return code;
}

/* A child that has ended may have told why before: that comes after the error that its end is. It
 * is not waited for. */
static ssize_t receive(const reader *r, reader_reply *reply) {
    ssize_t got = recv(r->socket, reply, sizeof *reply, MSG_DONTWAIT);
    if (got < 0 && (errno == ECONNRESET || errno == EPIPE)) {
        got = recv(r->socket, reply, sizeof *reply, MSG_DONTWAIT);
    }
    return got;
}

/* Its unpacked copies are too large, or others need the room. */
static int evict(reader *r, const shear_error *why, shear_error *err) {
    char ignored[160];
    if (r->pid > 0) {
        reap(r, true, ignored, sizeof ignored);
    }
    r->failure = *why;
    r->failed = why->code;
    if (err != NULL) {
        *err = *why;
    }
    return why->code;
}

/* Send a request and receive its reply: what the child itself says is in reply->code, its own
 * failure is returned. */
static int ask(reader *r, const reader_request *request, const char *what, reader_reply *reply,
               shear_error *err) {
    *reply = (reader_reply){.code = SHEAR_E_INTERNAL};
    if (r->failed != 0) {
        if (err != NULL) {
            *err = r->failure;
        }
        return r->failed;
    }
    shear_error why;
    if (send(r->socket, request, sizeof *request, MSG_NOSIGNAL) == (ssize_t)sizeof *request) {
        const int waited = wait_for_answer(r, &why);
        if (waited == SHEAR_E_FULL || waited == SHEAR_E_FORMAT) {
            return evict(r, &why, err);
        }
        if (waited != SHEAR_OK) {
            return give_up(r, waited, what, err);
        }
    }
    const ssize_t got = receive(r, reply);
    if (got <= 0) {
        return give_up(r, READER_E_DIED, what, err);
    }
    if (got != (ssize_t)sizeof *reply || reply->version != READER_WIRE_VERSION ||
        reply->op != request->op || reply->code < 0 || reply->code > SHEAR_E_FULL) {
        return give_up(r, READER_E_PROTOCOL, what, err);
    }
    reply->error.message[sizeof reply->error.message - 1] = '\0';
    reply->error.advice[sizeof reply->error.advice - 1] = '\0';
    const bool full = reply->code == SHEAR_E_FULL;
    const int room = scratch_check(&r->scratch, full, &why);
    if (room != SHEAR_OK && (full || reply->code == SHEAR_OK || room == SHEAR_E_FORMAT)) {
        return evict(r, &why, err); /* what never fits is the cause, whatever the reader found */
    }
    return reply->code == SHEAR_OK ? SHEAR_OK : failed_answer(reply, err);
}

static bool in_range(int64_t value, int64_t low, int64_t high) {
    return value >= low && value <= high;
}

static bool hdus_are_sane(const shear_field_info *info) {
    bool sane = true;
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        sane = sane && in_range(info->hdu[i], i == SHEAR_PART_CATALOG ? -1 : 0, INT32_MAX);
    }
    return sane;
}

static bool name_is_sane(const char *name) {
    while (*name >= ' ' && *name <= '~') {
        name++;
    }
    return *name == '\0';
}

/* Numbers that the daemon will allocate and index by. */
static bool info_is_sane(shear_field_info *info) {
    const shear_geometry *g = &info->geometry;
    info->name[sizeof info->name - 1] = '\0';
    return name_is_sane(info->name) && in_range(g->nx, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE) &&
           in_range(g->ny, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE) && in_range(g->psf_nx, 1, 4096) &&
           in_range(g->psf_ny, 1, 4096) && in_range(g->psf_oversample, 1, 64) &&
           in_range(info->n_stamps, 1, INT64_C(1) << 40) &&
           in_range(info->n_psf, 1, INT64_C(1) << 40) &&
           in_range(info->layout, SHEAR_LAYOUT_CUBE, SHEAR_LAYOUT_MOSAIC) &&
           in_range(info->psf_layout, SHEAR_PSF_ONE, SHEAR_PSF_BY_ID) && hdus_are_sane(info);
}

static void close_one(int fd) {
    if (fd >= 0) {
        close(fd);
    }
}

int reader_start(reader **out, const shear_input *input, const int *fds,
                 const reader_limits *limits, shear_error *err) {
    int pair[2] = {-1, -1};
    int said[2] = {-1, -1};
    reader *r = calloc(1, sizeof *r);
    *out = NULL;
    if (r == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a reader");
    }
    *r = (reader){.socket = -1,
                  .said = -1,
                  .timeout_ms = limits->timeout_ms,
                  .stop = limits->stop,
                  .shared_bytes = limits->shared_bytes};
    scratch_open(&r->scratch, limits->scratch, limits->scratch_bytes, limits->scratch_used,
                 input->path != NULL ? 1 : SHEAR_N_PARTS);
    r->memory_fd = memfd_create("sheard-stamps", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    int rc = r->memory_fd < 0 || socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) != 0
                 ? errno
                 : last_words_pipe(said);
    r->socket = pair[0];
    r->said = said[0];
    if (rc == 0) {
        const launch_ends ends = {pair[1], r->memory_fd, said[1], r->scratch.fds};
        rc = launch_reader(&r->pid, input, fds, ends, limits);
    }
    close_one(pair[1]);
    close_one(said[1]);
    if (rc != 0) {
        reader_stop(r);
        return shear_fail(err, SHEAR_E_IO, "is sheard-reader installed beside sheard?",
                          "the reader '%s' does not start: %s", limits->program, strerror(rc));
    }
    const reader_request request = {.version = READER_WIRE_VERSION, .op = READER_OPEN};
    reader_reply reply;
    int code = ask(r, &request, "open the file", &reply, err);
    if (code == SHEAR_OK && !info_is_sane(&reply.info)) {
        code = give_up(r, READER_E_PROTOCOL, "open the file", err);
    }
    if (code != SHEAR_OK) {
        reader_stop(r);
        return code;
    }
    r->info = reply.info;
    r->guards = reply.guards;
    *out = r;
    return SHEAR_OK;
}

void reader_stop(reader *r) {
    char ignored[160];
    if (r == NULL) {
        return;
    }
    close_one(r->socket);
    close_one(r->said);
    if (r->pid > 0) {
        reap(r, true, ignored, sizeof ignored);
    }
    if (r->memory != NULL) {
        munmap(r->memory, r->memory_bytes);
    }
    close_one(r->memory_fd);
    scratch_close(&r->scratch);
    free(r->blocks);
    free(r);
}

const shear_field_info *reader_get_info(const reader *r) {
    return &r->info;
}

unsigned reader_get_guards(const reader *r) {
    return r->guards;
}

static bool is_checksum(const char text[SHEAR_CHECKSUM_SIZE]) {
    return strnlen(text, SHEAR_CHECKSUM_SIZE) == SHEAR_CHECKSUM_SIZE - 1 &&
           strspn(text, "0123456789abcdef") == SHEAR_CHECKSUM_SIZE - 1;
}

int reader_checksum(reader *r, char out[SHEAR_CHECKSUM_SIZE], atomic_llong *hashed,
                    shear_error *err) {
    static const char what[] = "read the whole file";
    const reader_request request = {.version = READER_WIRE_VERSION, .op = READER_HASH};
    reader_reply reply = {.hashed = 0};
    for (int64_t before = 0;; before = reply.hashed) {
        const int code = ask(r, &request, what, &reply, err);
        if (code != SHEAR_OK) {
            return code;
        }
        const bool done = reply.checksum[0] != '\0';
        if (done ? !is_checksum(reply.checksum) : reply.hashed <= before) {
            return give_up(r, READER_E_PROTOCOL, what, err);
        }
        if (hashed != NULL) {
            atomic_store(hashed, reply.hashed);
        }
        if (done) {
            memcpy(out, reply.checksum, SHEAR_CHECKSUM_SIZE);
            return SHEAR_OK;
        }
        if (is_stopping(r)) {
            return give_up(r, READER_E_STOPPED, what, err);
        }
    }
}

/* Size the memory, and seal the size: a child that shrank it would crash the daemon. */
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
    r->slots = slots;
    r->capacity = capacity;
    r->psf_bytes = shear_psf_bytes(&r->info);
    r->slot_bytes = shear_block_bytes(&r->info, capacity);
    r->memory_bytes = r->psf_bytes + (size_t)slots * r->slot_bytes;
    if (r->memory_bytes > (size_t)r->shared_bytes) {
        return shear_fail(
            err, READER_E_MEMORY, "raise [reader] shared_memory, or cut smaller stamps and PSFs",
            "%d blocks of %d stamp pairs take %zu bytes of shared memory, allowed are %" PRId64,
            slots, capacity, r->memory_bytes, r->shared_bytes);
    }
    int code = make_memory(r, err);
    r->blocks = calloc((size_t)slots, sizeof *r->blocks);
    if (code == SHEAR_OK && r->blocks == NULL) {
        code = shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %d blocks", slots);
    }
    if (code != SHEAR_OK) {
        return code;
    }
    const reader_request request = {.version = READER_WIRE_VERSION,
                                    .op = READER_MAP,
                                    .slots = slots,
                                    .capacity = capacity,
                                    .slot_bytes = (int64_t)r->slot_bytes,
                                    .psf_bytes = (int64_t)r->psf_bytes};
    reader_reply reply;
    return ask(r, &request, "share memory", &reply, err);
}

int64_t reader_shared_bytes(const reader *r) {
    return (int64_t)r->memory_bytes;
}

int reader_read_psf(reader *r, int64_t index, const double **psf, shear_error *err) {
    const reader_request request = {
        .version = READER_WIRE_VERSION, .op = READER_PSF, .first = index};
    reader_reply reply;
    *psf = (const double *)(void *)r->memory;
    return ask(r, &request, "read a PSF", &reply, err);
}

int reader_read(void *self, int slot, int64_t first, int count, const shear_block **block,
                shear_error *err) {
    reader *r = self;
    const reader_request request = {.version = READER_WIRE_VERSION,
                                    .op = READER_STAMPS,
                                    .slot = slot,
                                    .first = first,
                                    .count = count};
    reader_reply reply;
    shear_block *b = &r->blocks[slot];
    /* The views are laid out anew on our side: nothing that the child writes is a pointer or a
     * size. */
    shear_block_place(b, &r->info, r->capacity,
                      r->memory + r->psf_bytes + (size_t)slot * r->slot_bytes);
    int code = ask(r, &request, "read stamps", &reply, err);
    if (code == SHEAR_OK && !in_range(reply.n_psf, 0, count)) {
        code = give_up(r, READER_E_PROTOCOL, "read stamps", err);
    }
    b->stamps.first = first;
    b->stamps.count = count;
    b->stamps.n_psf = reply.n_psf;
    *block = b;
    return code;
}
