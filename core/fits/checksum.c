/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear_file_checksum: XXH3 of the bytes as they are on disk, packed or not. */
#include "fits/source.h"
#include "shear/field.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
#include <xxhash.h>

enum { BUFFER = 1 << 20 };

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
