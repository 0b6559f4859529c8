/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/io/gunzip.h"

#include "base/cleanup.h"
#include "base/io.h"
#include "base/text.h"
#include "fits/io/scratch.h"
#include "shear/field.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
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
    int64_t limit = 0;
    return text != NULL && text_to_int64(text, &limit) && limit > 0 ? limit : SHEAR_UNPACK_LIMIT;
}

/* A file that is being unpacked. */
typedef struct unpacking {
    z_stream z;
    int in, out;
    int64_t position; /* packed bytes fed to zlib so far */
    int64_t written, limit;
    unsigned char *packed, *plain; /* [CHUNK] each */
    bool text;                     /* unpack a text, too */
    sf_place at;
} unpacking;

static int refill(unpacking *u, shear_error *err) {
    const ssize_t n = io_read_at(u->in, u->packed, CHUNK, u->position);
    if (n < 0)
        return sf_fail_errno(err, u->at, errno, "cannot read");
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
    const bool text = u->text && count > 0 && u->plain[0] == '#';
    if (u->written == 0 && !text && !sf_is_fits(u->plain, (int64_t)count)) {
        return sf_fail(err, SHEAR_E_FORMAT, u->at,
                       u->text ? "write the catalog with CATALOG_TYPE FITS_LDAC, or ASCII_HEAD"
                               : NULL,
                       "not a FITS file%s: the unpacked gzip data do not begin with 'SIMPLE  ='%s",
                       u->text ? " or SExtractor's ASCII_HEAD" : "", u->text ? " or '#'" : "");
    }
    if ((int64_t)count > u->limit - u->written) {
        return sf_fail(err, SHEAR_E_FORMAT, u->at,
                       "unpack it with gunzip, or raise the limit (SHEAR_UNPACK_LIMIT in bytes; "
                       "[reader] unpacked of the service)",
                       "the gzip data unpack to more than the limit of %lld bytes",
                       (long long)u->limit);
    }
    const int error = io_write(u->out, u->plain, count);
    u->written += (int64_t)count;
    u->z.next_out = u->plain;
    u->z.avail_out = CHUNK;
    return error == 0 ? SHEAR_OK
                      : sf_fail_errno(err, u->at, error, "cannot write its temporary copy");
}

/* Unpack until the end of one gzip member. */
static int unpack_member(unpacking *u, shear_error *err) {
    for (;;) {
        TRY(u->z.avail_in == 0 ? refill(u, err) : SHEAR_OK);
        const int z = inflate(&u->z, Z_NO_FLUSH);
        if (z == Z_STREAM_END)
            return SHEAR_OK;
        if (z == Z_MEM_ERROR)
            return sf_fail_memory(err, u->at);
        if (z != Z_OK && z != Z_BUF_ERROR) {
            return sf_fail(err, SHEAR_E_FORMAT, u->at, "copy the file again",
                           "the gzip data are damaged near byte %lld (%s)",
                           (long long)(u->position - u->z.avail_in),
                           u->z.msg != NULL ? u->z.msg : "no gzip stream");
        }
        TRY(u->z.avail_out == 0 ? flush(u, err) : SHEAR_OK);
    }
}

/* After a member: *more is whether another one follows; zero padding is the end. */
static int look_for_member(unpacking *u, bool *more, shear_error *err) {
    const int64_t next = u->position - u->z.avail_in;
    unsigned char head[2] = {0, 0};
    const ssize_t n = io_read_at(u->in, head, sizeof head, next);
    if (n < 0)
        return sf_fail_errno(err, u->at, errno, "cannot read");
    *more = n > 0 && head[0] != 0;
    if (*more && !sf_is_gzip(head, n)) {
        return sf_fail(err, SHEAR_E_FORMAT, u->at, "copy the file again",
                       "the gzip data are damaged: byte %lld begins something that is not gzip",
                       (long long)next);
    }
    inflateReset(&u->z);
    return SHEAR_OK;
}

static int unpack(unpacking *u, shear_error *err) {
    bool more = true;
    while (more) {
        TRY(unpack_member(u, err));
        TRY(look_for_member(u, &more, err));
    }
    return flush(u, err);
}

static void unpacking_deinit(unpacking *u) {
    inflateEnd(&u->z);
    free(u->packed);
    free(u->plain);
    release_fd(&u->out);
}

int sf_gunzip(int in, sf_place at, bool text, int *out, int64_t *out_size, shear_error *err) {
    CLEANUP(unpacking_deinit)
    unpacking u = {.in = in, .out = -1, .limit = unpack_limit(), .text = text, .at = at};
    u.packed = malloc(CHUNK);
    u.plain = malloc(CHUNK);
    u.z.next_out = u.plain;
    u.z.avail_out = CHUNK;
    if (u.packed == NULL || u.plain == NULL || /* 16: expect a gzip header and check its CRC */
        inflateInit2(&u.z, 15 + 16) != Z_OK) {
        return sf_fail_memory(err, at);
    }
    TRY(sf_scratch_open(at, &u.out, err));
    TRY(unpack(&u, err));
    *out = u.out;
    *out_size = u.written;
    u.out = -1;
    return SHEAR_OK;
}
