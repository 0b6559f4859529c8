/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checksums of inputs: XXH3 of the bytes as they are on disk, packed or not. */
#include "fits/source.h"
#include "shear/field.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

enum { BUFFER = 1 << 17 }; /* fits the second cache: what was read is still there */

static int digest_stream(int fd, XXH3_state_t *state, unsigned char *buffer, sf_place at,
                         shear_error *err) {
    for (off_t offset = 0;;) {
        const ssize_t n = pread(fd, buffer, BUFFER, offset);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n < 0) {
            return sf_fail_errno(err, at, errno, "cannot be read");
        }
        if (n == 0) {
            return SHEAR_OK;
        }
        XXH3_128bits_update(state, buffer, (size_t)n);
        offset += n;
    }
}

static void write_hex(XXH128_hash_t hash, char out[SHEAR_CHECKSUM_SIZE]) {
    snprintf(out, SHEAR_CHECKSUM_SIZE, "%016llx%016llx", (unsigned long long)hash.high64,
             (unsigned long long)hash.low64);
}

void shear_bytes_checksum(const void *bytes, size_t n, char out[SHEAR_CHECKSUM_SIZE]) {
    write_hex(XXH3_128bits(bytes, n), out);
}

int shear_fd_checksum(int fd, const char *name, char out[SHEAR_CHECKSUM_SIZE], shear_error *err) {
    char shown[161];
    sf_printable_name(shown, sizeof shown, name);
    const sf_place at = {shown, NULL};
    int64_t bytes = 0;
    int rc = sf_check_regular(fd, at, &bytes, err);
    if (rc != SHEAR_OK) {
        return rc;
    }
    XXH3_state_t *state = XXH3_createState();
    unsigned char *buffer = malloc(BUFFER);
    if (state == NULL || buffer == NULL) {
        rc = sf_fail_memory(err, at);
        goto done;
    }
    XXH3_128bits_reset(state);
    rc = digest_stream(fd, state, buffer, at, err);
    if (rc == SHEAR_OK) {
        const XXH128_hash_t hash = XXH3_128bits_digest(state);
        snprintf(out, SHEAR_CHECKSUM_SIZE, "%016llx%016llx", (unsigned long long)hash.high64,
                 (unsigned long long)hash.low64);
    }
done:
    free(buffer);
    XXH3_freeState(state);
    return rc;
}

int shear_file_checksum(const char *path, char out[SHEAR_CHECKSUM_SIZE], shear_error *err) {
    char shown[161];
    sf_printable_name(shown, sizeof shown, path);
    int fd = -1;
    int64_t bytes = 0;
    int rc = sf_open_regular(path, (sf_place){shown, NULL}, &fd, &bytes, err);
    if (rc == SHEAR_OK) {
        rc = shear_fd_checksum(fd, path, out, err);
        close(fd);
    }
    return rc;
}

/* ---- inputs ---- */

/* One file of an input: by its descriptor, or opened by its path. */
static int file_checksum(const char *path, int fd, char out[SHEAR_CHECKSUM_SIZE],
                         shear_error *err) {
    return fd >= 0 ? shear_fd_checksum(fd, path, out, err) : shear_file_checksum(path, out, err);
}

static bool same_file(const shear_input *input, const int *fds, int a, int b) {
    struct stat x;
    struct stat y;
    const bool known =
        fds != NULL ? fstat(fds[a], &x) == 0 && fstat(fds[b], &y) == 0
                    : stat(input->parts[a].path, &x) == 0 && stat(input->parts[b].path, &y) == 0;
    return known && x.st_dev == y.st_dev && x.st_ino == y.st_ino;
}

/* The sum of a part's file; a file of several parts is read once. A catalogue that is not given is
 * in the galaxies' file. */
static int part_checksum(const shear_input *input, const int *fds, int part,
                         char sums[SHEAR_N_PARTS][SHEAR_CHECKSUM_SIZE], shear_error *err) {
    if (input->parts[part].path == NULL) {
        memcpy(sums[part], sums[SHEAR_PART_GALAXY], SHEAR_CHECKSUM_SIZE);
        return SHEAR_OK;
    }
    for (int i = 0; i < part; i++) {
        if (input->parts[i].path != NULL && same_file(input, fds, i, part)) {
            memcpy(sums[part], sums[i], SHEAR_CHECKSUM_SIZE);
            return SHEAR_OK;
        }
    }
    return file_checksum(input->parts[part].path, fds != NULL ? fds[part] : -1, sums[part], err);
}

int shear_input_checksum(const shear_input *input, const int *fds, const shear_field_info *info,
                         char out[SHEAR_CHECKSUM_SIZE], shear_error *err) {
    if (input->path != NULL) {
        return file_checksum(input->path, fds != NULL ? fds[0] : -1, out, err);
    }
    char sums[SHEAR_N_PARTS][SHEAR_CHECKSUM_SIZE];
    char text[SHEAR_N_PARTS * 80] = "";
    int rc = SHEAR_OK;
    for (int i = 0; i < SHEAR_N_PARTS && rc == SHEAR_OK; i++) {
        if (info->hdu[i] >= 0) {
            const size_t used = strlen(text);
            rc = part_checksum(input, fds, i, sums, err);
            snprintf(text + used, sizeof text - used, "%s %s %lld\n", shear_part_name(i), sums[i],
                     (long long)info->hdu[i]);
        }
    }
    if (rc == SHEAR_OK && info->separate) {
        shear_bytes_checksum(text, strlen(text), out);
    } else if (rc == SHEAR_OK) {
        memcpy(out, sums[SHEAR_PART_GALAXY], SHEAR_CHECKSUM_SIZE);
    }
    return rc;
}
