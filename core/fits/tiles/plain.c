/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/tiles/plain.h"

#include "base/cleanup.h"
#include "base/io.h"
#include "base/simd.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <string.h>

/* The bytes that are read at once: they and their pixels are in the second cache. */
enum { CHUNK_BYTES = 1 << 16 };

/* ---- big-endian numbers as doubles ---- */

SHEAR_SIMD static void of_int16(double *restrict out, const uint16_t *restrict in, size_t n) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        out[i] = (int16_t)__builtin_bswap16(in[i]);
}

SHEAR_SIMD static void of_int32(double *restrict out, const uint32_t *restrict in, size_t n) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        out[i] = (int32_t)__builtin_bswap32(in[i]);
}

SHEAR_SIMD static void of_float(double *restrict out, const uint32_t *restrict in, size_t n) {
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        const uint32_t bits = __builtin_bswap32(in[i]);
        float value;
        memcpy(&value, &bits, sizeof value);
        out[i] = (double)value;
    }
}

SHEAR_SIMD static void of_double(double *restrict out, const uint64_t *restrict in, size_t n) {
    for (size_t i = 0; i < n; i++) {
        const uint64_t bits = __builtin_bswap64(in[i]);
        memcpy(&out[i], &bits, sizeof bits);
    }
}

/* Integers of 64 bits: some have no double of their own, so that BLANK is found here, and the usual
 * BZERO of unsigned ones is added here. */
static void of_int64(const sf_plain *p, double *out, const uint64_t *in, size_t n,
                     bool is_unsigned) {
    for (size_t i = 0; i < n; i++) {
        const uint64_t bits = __builtin_bswap64(in[i]);
        const uint64_t turned = bits ^ (UINT64_C(1) << 63);
        const double value = is_unsigned ? (double)turned : (double)(int64_t)bits;
        out[i] = p->has_blank && (int64_t)bits == p->blank ? (double)NAN : value;
    }
}

SHEAR_SIMD static void forget(double *v, size_t n, double blank) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        v[i] = v[i] == blank ? (double)NAN : v[i];
}

SHEAR_SIMD static void apply_scale(double *v, size_t n, double scale, double zero) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        v[i] = v[i] * scale + zero;
}

static void convert(const sf_plain *p, const void *raw, size_t n, double *out) {
    const bool is_unsigned = p->bitpix == 64 && p->scale == 1.0 && p->zero == 0x1p63;
    switch (p->bitpix) {
    case 8:
        for (size_t i = 0; i < n; i++)
            out[i] = ((const unsigned char *)raw)[i];
        break;
    case 16:
        of_int16(out, raw, n);
        break;
    case 32:
        of_int32(out, raw, n);
        break;
    case 64:
        of_int64(p, out, raw, n, is_unsigned);
        break;
    case -32:
        of_float(out, raw, n);
        break;
    default:
        of_double(out, raw, n);
    }
    if (p->has_blank && p->bitpix < 64)
        forget(out, n, (double)p->blank);
    if (!is_unsigned && (p->scale != 1.0 || p->zero != 0.0))
        apply_scale(out, n, p->scale, p->zero);
}

/* ---- reading ---- */

/* Read n pixels that follow each other in the file, from number `first` on. */
static int read_run(const sf_plain *p, int64_t first, int64_t n, double *out, shear_error *err) {
    uint64_t raw[CHUNK_BYTES / sizeof(uint64_t)];
    const int64_t width = (p->bitpix < 0 ? -p->bitpix : p->bitpix) / 8;
    const int64_t most = CHUNK_BYTES / width;
    for (int64_t done = 0; done < n; done += most) {
        const int64_t count = n - done < most ? n - done : most;
        const size_t bytes = (size_t)(count * width);
        const int64_t from = p->data_offset + (first + done) * width;
        const ssize_t got = io_read_at(p->file->source.fd, raw, bytes, (off_t)from);
        if (got < 0)
            return sf_fail_errno(err, p->at, errno, "its pixels cannot be read");
        if ((size_t)got < bytes) {
            return sf_fail(err, SHEAR_E_FORMAT, p->at, "was it changed meanwhile? try again",
                           "its pixels cannot be read: the file ends early");
        }
        convert(p, raw, (size_t)count, out + done);
    }
    return SHEAR_OK;
}

int sf_plain_read(const sf_plain *p, const int64_t first[SF_AXES], const int64_t size[SF_AXES],
                  double *out, shear_error *err) {
    assert(p->bitpix == 8 || p->bitpix == 16 || p->bitpix == 32 || p->bitpix == 64 ||
           p->bitpix == -32 || p->bitpix == -64);
    const bool rows = size[0] == p->axes[0]; /* whole ones follow each other */
    const bool planes = rows && size[1] == p->axes[1];
    const int64_t run = size[0] * (rows ? size[1] : 1) * (planes ? size[2] : 1);
    const int64_t in_plane = rows ? 1 : size[1];
    const int64_t runs = in_plane * (planes ? 1 : size[2]);
    for (int64_t i = 0; i < runs; i++) {
        const int64_t z = first[2] + i / in_plane;
        const int64_t y = first[1] + i % in_plane;
        TRY(read_run(p, (z * p->axes[1] + y) * p->axes[0] + first[0], run, out + i * run, err));
    }
    return SHEAR_OK;
}

bool sf_plain_fits_float(const sf_plain *p) {
    const bool is_short = p->bitpix == 8 || p->bitpix == 16;
    const bool whole = fabs(p->zero) <= 0x1p20 && p->zero == trunc(p->zero);
    return p->scale == 1.0 && ((p->bitpix == -32 && p->zero == 0.0) || (is_short && whole));
}
