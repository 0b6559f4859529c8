/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read rows of a binary table as numbers, converted and scaled. */
#include "base/io.h"

#include "base/cleanup.h"
#include "fits/header/table.h"
#include "fits/io/bits.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <string.h>

enum { BUFFER = 1 << 15 };

int sf_table_bytes(const sf_table *t, int64_t row, int64_t offset, int64_t bytes, void *out,
                   shear_error *err) {
    assert(row >= 0 && offset >= 0 && bytes >= 0);
    const int64_t at = t->hdu->data_offset + row * t->hdu->axes[0] + offset;
    const ssize_t n = io_read_at(t->file->source.fd, out, (size_t)bytes, (off_t)at);
    if (n < 0)
        return sf_fail_errno(err, t->cards->at, errno, "cannot be read");
    if (n < bytes) {
        return sf_fail(err, SHEAR_E_FORMAT, t->cards->at, "leave a file alone while it is read",
                       "its data end at row %lld: the file has become shorter", (long long)row + 1);
    }
    return SHEAR_OK;
}

/* A cell as stored: an integer or a floating-point number, or undefined. */
typedef struct stored_cell {
    bool floating, undefined;
    int64_t integer;
    double real;
} stored_cell;

static stored_cell real_of(double v) {
    return (stored_cell){.floating = true, .real = v, .undefined = isnan(v)};
}

static stored_cell integer_of(const sf_scaling *by, int64_t v) {
    return (stored_cell){.integer = v, .undefined = by->has_null && v == by->null};
}

static stored_cell stored_cell_of(const sf_column *c, const unsigned char *bytes) {
    const uint64_t bits = sf_bits_big_endian(bytes, c->width);
    switch (c->type) {
    case 'L':
        return (stored_cell){.integer = bits == 'T' ? 1 : 0,
                             .undefined = bits != 'T' && bits != 'F'};
    case 'B':
    case 'K':
        return integer_of(&c->by, (int64_t)bits);
    case 'I':
        return integer_of(&c->by, (int16_t)bits);
    case 'J':
        return integer_of(&c->by, (int32_t)bits);
    case 'E': {
        const uint32_t low = (uint32_t)bits;
        float v;
        memcpy(&v, &low, sizeof v);
        return real_of((double)v);
    }
    default: {
        double v;
        memcpy(&v, &bits, sizeof v);
        return real_of(v);
    }
    }
}

typedef struct sink {
    const sf_column *column;
    double *doubles; /* output: either doubles or integers is set */
    int64_t *integers;
    int64_t undefined;
} sink;

static double as_double(const sf_scaling *by, stored_cell c) {
    if (c.undefined)
        return NAN;
    const double v = c.floating ? c.real : (double)c.integer;
    return by->scale == 1.0 && by->zero == 0.0 ? v : v * by->scale + by->zero;
}

static int64_t as_integer(const sf_scaling *by, stored_cell c, int64_t undefined) {
    int64_t sum = 0;
    if (!c.floating && !c.undefined) {
        if (by->is_unsigned)
            return (int64_t)((uint64_t)c.integer + (UINT64_C(1) << 63));
        if (by->whole)
            return __builtin_add_overflow(c.integer, by->whole_zero, &sum) ? undefined : sum;
    }
    const double v = as_double(by, c);
    return v == floor(v) && fabs(v) < 0x1p63 ? (int64_t)v : undefined; /* NaN fails both tests */
}

static void put(const sink *s, int64_t i, const unsigned char *bytes) {
    const stored_cell c = stored_cell_of(s->column, bytes);
    if (s->doubles != NULL) {
        s->doubles[i] = as_double(&s->column->by, c);
    } else {
        s->integers[i] = as_integer(&s->column->by, c, s->undefined);
    }
}

/* Read whole rows at a time if they are short, else cell by cell. */
static int read_rows(const sf_table *t, const sink *s, int64_t first, int64_t count,
                     shear_error *err) {
    unsigned char buffer[BUFFER] = {0};
    const sf_column *c = s->column;
    const int64_t row = t->hdu->axes[0];
    const int64_t many = row <= BUFFER ? BUFFER / row : 1;
    const bool cells = row > BUFFER;
    for (int64_t done = 0; done < count;) {
        const int64_t n = count - done < many ? count - done : many;
        TRY(sf_table_bytes(t, first + done, cells ? c->offset : 0, cells ? c->width : n * row,
                           buffer, err));
        for (int64_t i = 0; i < n; i++)
            put(s, done + i, buffer + (cells ? 0 : i * row + c->offset));
        done += n;
    }
    return SHEAR_OK;
}

int sf_table_doubles(const sf_table *t, const sf_column *column, int64_t first, int64_t count,
                     double *out, shear_error *err) {
    const sink s = {.column = column, .doubles = out};
    return read_rows(t, &s, first, count, err);
}

int sf_table_integers(const sf_table *t, const sf_column *column, int64_t first, int64_t count,
                      int64_t undefined, int64_t *out, shear_error *err) {
    const sink s = {.column = column, .integers = out, .undefined = undefined};
    return read_rows(t, &s, first, count, err);
}
