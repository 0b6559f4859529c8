/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/symmetry.h"

#include "base/array.h"
#include "base/cleanup.h"
#include "measure/block_sums.h"

#include <endian.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N_DOUBLES = SHEAR_SYMMETRY_BYTES / sizeof(uint64_t) };
_Static_assert(sizeof(symmetry_terms) == N_DOUBLES * sizeof(double), "seven doubles, no padding");

int shear_symmetry_new(shear_symmetry **out, shear_error *err) {
    *out = calloc(1, sizeof **out);
    if (*out == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field's terms");
    return SHEAR_OK;
}

void shear_symmetry_free(shear_symmetry *s) {
    if (s != NULL) {
        free(s->stamps);
        free(s);
    }
}

static int reserve(shear_symmetry *s, size_t more, shear_error *err) {
    return ARRAY_RESERVE(s->stamps, s->capacity, s->n + more)
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the terms of %zu stamps",
                            s->n + more);
}

int shear_symmetry_add(shear_symmetry *s, const shear_row *row, double beta_px, shear_error *err) {
    double sums[SHEAR_N_TERMS];
    const double beta2 = beta_px * beta_px;
    const symmetry_terms t = {.n1 = row->n1 + row->cross_n1,
                              .n2 = row->n2 + row->cross_n2,
                              .d = row->d + row->cross_d,
                              .u = -0.5 * beta2 * (row->u + row->cross_u),
                              .v = -2.0 * beta2 * (row->v + row->cross_v),
                              .weight = row->weight,
                              .excess = row->high_galaxy - row->high_noise};
    const bool finite = isfinite(t.n1 + t.n2 + t.d) && isfinite(t.u + t.v);
    if (row->flags != 0 || !block_terms(row, sums) || !finite)
        return SHEAR_OK;
    TRY(reserve(s, 1, err));
    s->stamps[s->n++] = t;
    return SHEAR_OK;
}

int shear_symmetry_join(shear_symmetry *s, const shear_symmetry *other, size_t from,
                        shear_error *err) {
    const size_t n = other->n > from ? other->n - from : 0;
    const int code = reserve(s, n, err);
    if (code != SHEAR_OK || n == 0)
        return code;
    memcpy(s->stamps + s->n, other->stamps + from, n * sizeof *other->stamps);
    s->n += n;
    return SHEAR_OK;
}

void shear_symmetry_truncate(shear_symmetry *s, size_t n) {
    s->n = n < s->n ? n : s->n;
}

size_t shear_symmetry_count(const shear_symmetry *s) {
    return s->n;
}

void shear_symmetry_powers(const shear_symmetry *s, double *weight, double *d) {
    for (size_t i = 0; i < s->n; i++) {
        weight[i] = s->stamps[i].weight;
        d[i] = s->stamps[i].d;
    }
}

/* Copy n doubles from the machine's order of bytes to the lowest first, or back. */
static void convert(const void *from, size_t n, void *to) {
    for (size_t i = 0; i < n; i++) {
        uint64_t bits;
        memcpy(&bits, (const char *)from + i * sizeof bits, sizeof bits);
        bits = htole64(bits);
        memcpy((char *)to + i * sizeof bits, &bits, sizeof bits);
    }
}

void shear_symmetry_bytes(const shear_symmetry *s, size_t from, unsigned char *out) {
    if (from < s->n)
        convert(s->stamps + from, (s->n - from) * N_DOUBLES, out);
}

static bool read_terms(const unsigned char *bytes, symmetry_terms *t) {
    convert(bytes, N_DOUBLES, t);
    return isfinite(t->n1) && isfinite(t->n2) && isfinite(t->d) && isfinite(t->u) &&
           isfinite(t->v) && isfinite(t->weight) && isfinite(t->excess) && t->weight >= 0.0;
}

int shear_symmetry_add_bytes(shear_symmetry *s, const unsigned char *bytes, size_t size,
                             shear_error *err) {
    const size_t n = size / SHEAR_SYMMETRY_BYTES;
    bool good = size % SHEAR_SYMMETRY_BYTES == 0;
    TRY(good ? reserve(s, n, err) : SHEAR_OK);
    for (size_t i = 0; i < n && good; i++)
        good = read_terms(bytes + i * SHEAR_SYMMETRY_BYTES, &s->stamps[s->n + i]);
    if (!good) {
        return shear_fail(err, SHEAR_E_FORMAT, NULL,
                          "these %zu bytes are not the terms of a field's stamps", size);
    }
    s->n += n;
    return SHEAR_OK;
}
