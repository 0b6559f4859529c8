/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/io/gunzip.h"

#include "shear/field.h"

#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

enum { CHUNK = 1 << 18 };

bool sf_is_fits(const unsigned char *bytes, int64_t count) {
    return count >= 9 && memcmp(bytes, "SIMPLE  =", 9) == 0;
}

bool sf_is_gzip(const unsigned char *bytes, int64_t count) {
    return count >= 2 && bytes[0] == 0x1f && bytes[1] == 0x8b;
}

static int64_t unpack_limit(void) {
    const char *text = getenv("SHEAR_UNPACK_LIMIT");
    if (text == NULL) {
        return SHEAR_UNPACK_LIMIT;
    }
    char *end = NULL;
    errno = 0;
    const long long value = strtoll(text, &end, 10);
    return errno == 0 && end != text && *end == '\0' && value > 0 ? value : SHEAR_UNPACK_LIMIT;
}

/* Given to this process, which may open none. */
static int given[8];
static int n_given;
static atomic_int next_given;

void shear_field_use_scratch(const int *fds, int n) {
    n_given = n < (int)(sizeof given / sizeof *given) ? n : (int)(sizeof given / sizeof *given);
    memcpy(given, fds, (size_t)n_given * sizeof *given);
}

static int take_given(sf_place at, int *out, shear_error *err) {
    const int i = atomic_fetch_add(&next_given, 1);
    if (i >= n_given) {
        return sf_fail(err, SHEAR_E_IO, at, "look at the directory for unpacked copies",
                       "there is no file to unpack it into");
    }
    *out = given[i];
    return SHEAR_OK;
}

static int temporary(sf_place at, int *out, shear_error *err) {
    if (n_given > 0) {
        return take_given(at, out, err);
    }
    const char *dir = getenv("TMPDIR");
    if (dir == NULL || dir[0] == '\0') {
        dir = "/tmp";
    }
    int fd = open(dir, O_TMPFILE | O_RDWR | O_EXCL | O_CLOEXEC, 0600);
    if (fd < 0) { /* not every file system knows O_TMPFILE */
        char path[4096];
        const int n = snprintf(path, sizeof path, "%s/.shear-XXXXXX", dir);
        fd = n > 0 && (size_t)n < sizeof path ? mkostemp(path, O_CLOEXEC) : -1;
        if (fd >= 0) {
            unlink(path);
        }
    }
    if (fd < 0) {
        const int number = errno;
        char doing[300];
        snprintf(doing, sizeof doing, "cannot make a temporary file in '%.200s' (TMPDIR)", dir);
        return sf_fail_errno(err, at, number, doing);
    }
    *out = fd;
    return SHEAR_OK;
}

static int write_all(int fd, const unsigned char *bytes, size_t count, sf_place at,
                     shear_error *err) {
    while (count > 0) {
        const ssize_t n = write(fd, bytes, count);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n < 0) {
            return sf_fail_errno(err, at, errno, "cannot write its temporary copy");
        }
        bytes += n;
        count -= (size_t)n;
    }
    return SHEAR_OK;
}

/* Bytes read, 0 at the end, or -1 with errno. */
static ssize_t read_at(int fd, void *buffer, size_t count, int64_t offset) {
    ssize_t n;
    do {
        n = pread(fd, buffer, count, (off_t)offset);
    } while (n < 0 && errno == EINTR);
    return n;
}

/* One file being unpacked. */
typedef struct unpacking {
    z_stream z;
    int in, out;
    int64_t position; /* packed bytes fed to zlib so far */
    int64_t written, limit;
    unsigned char *packed, *plain; /* [CHUNK] each */
    sf_place at;
} unpacking;

static int refill(unpacking *u, shear_error *err) {
    const ssize_t n = read_at(u->in, u->packed, CHUNK, u->position);
    if (n < 0) {
        return sf_fail_errno(err, u->at, errno, "cannot read");
    }
    if (n == 0) {
        return sf_fail(err, SHEAR_E_FORMAT, u->at, "copy the file again",
                       "the gzip data are truncated: they end after %lld bytes, before the end of "
                       "the packed stream",
                       (long long)u->position);
    }
    u->position += n;
    u->z.next_in = u->packed;
    u->z.avail_in = (uInt)n;
    return SHEAR_OK;
}

static int flush(unpacking *u, shear_error *err) {
    const size_t count = CHUNK - u->z.avail_out;
    if (u->written == 0 && !sf_is_fits(u->plain, (int64_t)count)) {
        return sf_fail(err, SHEAR_E_FORMAT, u->at, NULL,
                       "not a FITS file: the unpacked gzip data do not begin with 'SIMPLE  ='");
    }
    if ((int64_t)count > u->limit - u->written) {
        return sf_fail(err, SHEAR_E_FORMAT, u->at,
                       "unpack it with gunzip, or raise the limit (SHEAR_UNPACK_LIMIT in bytes; "
                       "[reader] unpacked of the service)",
                       "the gzip data unpack to more than the limit of %lld bytes",
                       (long long)u->limit);
    }
    const int rc = write_all(u->out, u->plain, count, u->at, err);
    u->written += (int64_t)count;
    u->z.next_out = u->plain;
    u->z.avail_out = CHUNK;
    return rc;
}

/* Unpack until the end of one gzip member. */
static int unpack_member(unpacking *u, shear_error *err) {
    for (;;) {
        int rc = u->z.avail_in == 0 ? refill(u, err) : SHEAR_OK;
        if (rc != SHEAR_OK) {
            return rc;
        }
        const int z = inflate(&u->z, Z_NO_FLUSH);
        if (z == Z_STREAM_END) {
            return SHEAR_OK;
        }
        if (z == Z_MEM_ERROR) {
            return sf_fail_memory(err, u->at);
        }
        if (z != Z_OK && z != Z_BUF_ERROR) {
            return sf_fail(err, SHEAR_E_FORMAT, u->at, "copy the file again",
                           "the gzip data are damaged near byte %lld (%s)",
                           (long long)(u->position - u->z.avail_in),
                           u->z.msg != NULL ? u->z.msg : "no gzip stream");
        }
        rc = u->z.avail_out == 0 ? flush(u, err) : SHEAR_OK;
        if (rc != SHEAR_OK) {
            return rc;
        }
    }
}

/* After a member: 1 = another one follows, 0 = the end (zero padding is allowed), negative = an
 * error. */
static int more_members(unpacking *u, shear_error *err) {
    const int64_t next = u->position - u->z.avail_in;
    unsigned char head[2] = {0, 0};
    const ssize_t n = read_at(u->in, head, sizeof head, next);
    if (n < 0) {
        return -sf_fail_errno(err, u->at, errno, "cannot read");
    }
    if (n == 0 || head[0] == 0) {
        return 0;
    }
    if (!sf_is_gzip(head, n)) {
        return -sf_fail(err, SHEAR_E_FORMAT, u->at, "copy the file again",
                        "the gzip data are damaged: byte %lld begins something that is not gzip",
                        (long long)next);
    }
    inflateReset(&u->z);
    return 1;
}

static int unpack(unpacking *u, shear_error *err) {
    int more = 1;
    while (more > 0) {
        const int rc = unpack_member(u, err);
        if (rc != SHEAR_OK) {
            return rc;
        }
        more = more_members(u, err);
    }
    return more < 0 ? -more : flush(u, err);
}

int sf_gunzip(int in, sf_place at, int *out, int64_t *out_size, shear_error *err) {
    unpacking u = {.in = in, .out = -1, .limit = unpack_limit(), .at = at};
    int rc = SHEAR_OK;
    if (inflateInit2(&u.z, 15 + 16) != Z_OK) { /* 16: expect gzip's header and check its CRC */
        return sf_fail_memory(err, at);
    }
    u.packed = malloc(CHUNK);
    u.plain = malloc(CHUNK);
    if (u.packed == NULL || u.plain == NULL) {
        rc = sf_fail_memory(err, at);
        goto done;
    }
    u.z.next_out = u.plain;
    u.z.avail_out = CHUNK;
    rc = temporary(at, &u.out, err);
    if (rc == SHEAR_OK) {
        rc = unpack(&u, err);
    }
done:
    inflateEnd(&u.z);
    free(u.packed);
    free(u.plain);
    if (rc != SHEAR_OK && u.out >= 0) {
        close(u.out);
        u.out = -1;
    }
    *out = u.out;
    *out_size = u.written;
    return rc;
}
