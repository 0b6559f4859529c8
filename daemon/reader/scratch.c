/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "reader/scratch.h"

#include "base/cleanup.h"
#include "base/io.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

/* Bytes left free on the disk of the unpacked copies, which may also hold the service's state: a
 * gibibyte, or an eighth of a small disk. */
static const int64_t reserve_bytes = INT64_C(1) << 30;
enum { RESERVE_PART = 8 };

void scratch_open(scratch *s, const char *directory, int64_t most, atomic_llong *used, int n) {
    *s = (scratch){.directory = directory, .most = most, .used = used};
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        s->fds[i] = i < n ? io_open_nameless(directory) : -1;
}

static void account(scratch *s, int64_t own) {
    if (s->used != NULL)
        atomic_fetch_add(s->used, own - s->own);
    s->own = own;
}

void scratch_close(scratch *s) {
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        release_fd(&s->fds[i]);
    account(s, 0);
}

static int64_t occupied(const scratch *s) {
    int64_t bytes = 0;
    struct stat st;
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        if (s->fds[i] >= 0 && fstat(s->fds[i], &st) == 0)
            bytes += (int64_t)st.st_blocks * 512;
    }
    return bytes;
}

int scratch_check(scratch *s, bool full, shear_error *err) {
    struct statvfs disk;
    account(s, occupied(s));
    if (s->own == 0 && !full)
        return SHEAR_OK;
    int64_t capacity = s->most;
    bool low = full;
    if (s->fds[0] >= 0 && fstatvfs(s->fds[0], &disk) == 0) {
        const int64_t size = (int64_t)disk.f_blocks * (int64_t)disk.f_frsize;
        const int64_t part = size / RESERVE_PART;
        const int64_t reserve = part < reserve_bytes ? part : reserve_bytes;
        capacity = size - reserve < capacity ? size - reserve : capacity;
        low = low || (int64_t)disk.f_bavail * (int64_t)disk.f_frsize < reserve;
    }
    if (s->own > capacity) {
        return shear_fail(err, SHEAR_E_FORMAT, "submit the file unpacked",
                          "unpacked, it takes more than the %lld bytes that there can be room for "
                          "([reader] scratch_bytes, and the disk of %.200s)",
                          (long long)capacity, s->directory);
    }
    const bool shared_out = s->used != NULL && atomic_load(s->used) > s->most;
    if (!low && !shared_out)
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_FULL,
                      "free space there, set another directory ([reader] scratch), or submit "
                      "fewer gzipped files at once",
                      "no room in %.200s for its unpacked copy now: %s", s->directory,
                      low ? "the disk is nearly full" : "[reader] scratch_bytes are taken");
}

/* ---- choice of the directory ---- */

static bool works(const char *directory) {
    CLEANUP(release_fd)
    int fd = directory != NULL && directory[0] == '/' ? io_open_nameless(directory) : -1;
    return fd >= 0;
}

int scratch_find(char *out, size_t size, const char *wanted, const char *otherwise,
                 shear_error *err) {
    const char *const others[] = {getenv("TMPDIR"), "/var/tmp", otherwise};
    if (wanted[0] != '\0') {
        const bool made = mkdir(wanted, 0700) == 0 || errno == EEXIST;
        snprintf(out, size, "%s", wanted);
        return made && works(wanted)
                   ? SHEAR_OK
                   : shear_fail(err, SHEAR_E_IO, "create it for the service's user, or set another",
                                "no file can be made in the directory [reader] scratch, %.300s: %s",
                                wanted, strerror(errno));
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        if (works(others[i])) {
            snprintf(out, size, "%s", others[i]);
            return SHEAR_OK;
        }
    }
    return shear_fail(err, SHEAR_E_IO, "set a directory: [reader] scratch",
                      "no file can be made in $TMPDIR, /var/tmp or %.300s", otherwise);
}
