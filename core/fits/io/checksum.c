/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checksums of inputs: XXH3 of the bytes on disk, packed or not. */
#include "base/io.h"

#include "base/cleanup.h"
#include "base/fingerprint.h"
#include "base/text.h"
#include "common/release.h"
#include "fits/io/source.h"
#include "shear/field.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <xxhash.h>

enum { BUFFER = 1 << 17 }; /* fits into the second-level cache */

static void write_hex(XXH128_hash_t hash, char out[SHEAR_CHECKSUM_SIZE]) {
    snprintf(out, SHEAR_CHECKSUM_SIZE, "%016llx%016llx", (unsigned long long)hash.high64,
             (unsigned long long)hash.low64);
}

void shear_bytes_checksum(const void *bytes, size_t n, char out[SHEAR_CHECKSUM_SIZE]) {
    write_hex(XXH3_128bits(bytes, n), out);
}

/* ---- one file ---- */

typedef struct stream {
    int fd; /* -1: closed */
    int64_t offset, size;
    char name[161]; /* for messages */
} stream;

static void stream_close(stream *f) {
    release_fd(&f->fd);
    *f = (stream){.fd = -1};
}

/* Open a file by its path, or a duplicate of its descriptor if fd >= 0. */
static int stream_open(stream *f, const char *path, int fd, shear_error *err) {
    sf_printable_name(f->name, sizeof f->name, path);
    return sf_open_regular(path, fd, (sf_place){f->name, NULL}, &f->fd, &f->size, err);
}

/* Read one buffer more; *count = 0 at the end. A file that keeps growing is an error, because it
 * would never end. */
static int stream_read(stream *f, unsigned char *buffer, size_t *count, shear_error *err) {
    const sf_place at = {f->name, NULL};
    const ssize_t n = io_read_at(f->fd, buffer, BUFFER, f->offset);
    if (n < 0)
        return sf_fail_errno(err, at, errno, "cannot be read");
    if (n > f->size - f->offset) {
        return sf_fail(err, SHEAR_E_IO, at, "leave a file alone while it is read",
                       "grows while it is read: it had %lld bytes", (long long)f->size);
    }
    f->offset += n;
    *count = (size_t)n;
    return SHEAR_OK;
}

/* ---- inputs ---- */

struct shear_hashing {
    const shear_input *input;
    const int *fds;
    bool whole, separate;
    long long hdu[SHEAR_N_PARTS];
    int file_of[SHEAR_N_PARTS]; /* the part in whose file this one is: itself, or an earlier one;
                                   -1: there is no such part */
    char sums[SHEAR_N_PARTS][SHEAR_CHECKSUM_SIZE]; /* of the parts' files */
    int part;       /* the part that is being read; SHEAR_N_PARTS: all have been read */
    stream file;    /* its file, once it is open */
    int64_t before; /* bytes of the files that have been read completely */
    XXH3_state_t *state;
    unsigned char *buffer; /* [BUFFER] */
};

static const char *path_of(const shear_hashing *h, int part) {
    return h->whole ? h->input->path : h->input->parts[part].path;
}

static bool same_file(const shear_input *input, const int *fds, int a, int b) {
    struct stat x;
    struct stat y;
    const bool known =
        fds != NULL ? fstat(fds[a], &x) == 0 && fstat(fds[b], &y) == 0
                    : stat(input->parts[a].path, &x) == 0 && stat(input->parts[b].path, &y) == 0;
    return known && fingerprint_same_file(&x, &y);
}

/* Return the part in whose file this part is, so that a file of several parts is read once. A
 * catalog that is not given is in the galaxies' file. */
static int find_file(const shear_hashing *h, int part) {
    if (h->input->parts[part].path == NULL)
        return SHEAR_PART_GALAXY;
    for (int i = 0; i < part; i++) {
        if (h->input->parts[i].path != NULL && same_file(h->input, h->fds, i, part))
            return i;
    }
    return part;
}

int shear_hashing_new(shear_hashing **out, const shear_input *input, const int *fds,
                      const shear_field_info *info, shear_error *err) {
    CLEANUP(shear_hashing_release) shear_hashing *h = calloc(1, sizeof *h);
    *out = NULL;
    if (h != NULL) {
        *h = (shear_hashing){.input = input,
                             .fds = fds,
                             .whole = input->path != NULL,
                             .file.fd = -1,
                             .separate = info != NULL && info->separate,
                             .state = XXH3_createState(),
                             .buffer = malloc(BUFFER)};
    }
    if (h == NULL || h->state == NULL || h->buffer == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a checksum");
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        const bool there = h->whole                            ? i == 0
                           : shear_input_is_exposure(h->input) ? input->parts[i].path != NULL
                                                               : info != NULL && info->hdu[i] >= 0;
        h->hdu[i] = info != NULL ? (long long)info->hdu[i] : -1;
        h->file_of[i] = !there ? -1 : h->whole ? 0 : find_file(h, i);
    }
    *out = CLEANUP_TAKE(h);
    return SHEAR_OK;
}

void shear_hashing_free(shear_hashing *h) {
    if (h != NULL) {
        stream_close(&h->file);
        XXH3_freeState(h->state);
        free(h->buffer);
        free(h);
    }
}

int64_t shear_hashing_bytes(const shear_hashing *h) {
    return h->before + h->file.offset;
}

/* Begin the next part: open its file, or skip it if there is nothing to read for it. */
static int begin_part(shear_hashing *h, shear_error *err) {
    if (h->file_of[h->part] != h->part) {
        h->part++;
        return SHEAR_OK;
    }
    XXH3_128bits_reset(h->state);
    return stream_open(&h->file, path_of(h, h->part), h->fds != NULL ? h->fds[h->part] : -1, err);
}

static void end_part(shear_hashing *h) {
    write_hex(XXH3_128bits_digest(h->state), h->sums[h->part]);
    h->before += h->file.offset;
    stream_close(&h->file);
    h->part++;
}

/* Read one buffer of the current part, or begin or end it. */
static int hash_some(shear_hashing *h, shear_error *err) {
    size_t count = 0;
    if (h->file.fd < 0)
        return begin_part(h, err);
    TRY(stream_read(&h->file, h->buffer, &count, err));
    if (count > 0) {
        XXH3_128bits_update(h->state, h->buffer, count);
    } else {
        end_part(h);
    }
    return SHEAR_OK;
}

int shear_hashing_step(shear_hashing *h, int64_t bytes, bool *done, shear_error *err) {
    const int64_t begun = shear_hashing_bytes(h);
    *done = false;
    while (h->part < SHEAR_N_PARTS && shear_hashing_bytes(h) - begun < bytes)
        TRY(hash_some(h, err));
    *done = h->part == SHEAR_N_PARTS;
    return SHEAR_OK;
}

/* Append which HDU a part is: its number; of an exposure, whose parts may be in many HDUs, that of
 * the chosen one, -1 if none was; and if the chosen name is of several, that name, in any case of
 * letters. */
static void append_hdu(const shear_hashing *h, int part, char *text, size_t size) {
    const shear_input_part *chosen = &h->input->parts[part];
    if (!shear_input_is_exposure(h->input)) {
        text_append(text, size, "%lld\n", h->hdu[part]);
        return;
    }
    text_append(text, size, "%lld ", h->hdu[part]);
    for (const char *c = chosen->extname; h->hdu[part] < 0 && c != NULL && *c != '\0'; c++)
        text_append(text, size, "%c", toupper((unsigned char)*c));
    text_append(text, size, "\n");
}

void shear_hashing_text(const shear_hashing *h, char out[SHEAR_CHECKSUM_SIZE]) {
    char text[SHEAR_N_PARTS * 160] = "";
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        if (h->file_of[i] >= 0) {
            text_append(text, sizeof text, "%s %s ", shear_part_name(i), h->sums[h->file_of[i]]);
            append_hdu(h, i, text, sizeof text);
        }
    }
    if (!h->whole && h->separate) {
        shear_bytes_checksum(text, strlen(text), out);
    } else {
        memcpy(out, h->sums[SHEAR_PART_GALAXY], SHEAR_CHECKSUM_SIZE);
    }
}

int shear_input_checksum(const shear_input *input, const int *fds, const shear_field_info *info,
                         char out[SHEAR_CHECKSUM_SIZE], shear_error *err) {
    CLEANUP(shear_hashing_release) shear_hashing *h = NULL;
    bool done = false;
    TRY(shear_hashing_new(&h, input, fds, info, err));
    TRY(shear_hashing_step(h, INT64_MAX, &done, err));
    shear_hashing_text(h, out);
    return SHEAR_OK;
}

int shear_fd_checksum(int fd, const char *name, char out[SHEAR_CHECKSUM_SIZE], shear_error *err) {
    const shear_input input = shear_input_of_file(name);
    return shear_input_checksum(&input, &fd, NULL, out, err);
}

int shear_file_checksum(const char *path, char out[SHEAR_CHECKSUM_SIZE], shear_error *err) {
    const shear_input input = shear_input_of_file(path);
    return shear_input_checksum(&input, NULL, NULL, out, err);
}
