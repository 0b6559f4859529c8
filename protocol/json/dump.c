/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json_dumps of jansson up to at least 2.14 passes over a failure to write a member's name: where
 * memory is scarce, it returns a text with the name left out. So the bytes are collected here, and
 * a failure is remembered. */
#include "json/dump.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct sink {
    char *bytes;
    size_t used, size;
    bool failed;
} sink;

static bool make_room(sink *s, size_t n) {
    if (n <= s->size - s->used) {
        return true;
    }
    const size_t wanted = n > SIZE_MAX - s->used ? 0 : s->used + n;
    const size_t doubled = s->size > SIZE_MAX / 2 ? 0 : 2 * s->size;
    const size_t size = wanted > doubled ? wanted : doubled;
    char *larger = wanted > 0 ? realloc(s->bytes, size) : NULL;
    if (larger == NULL) {
        return false;
    }
    s->bytes = larger;
    s->size = size;
    return true;
}

static int collect(const char *bytes, size_t n, void *data) {
    sink *s = data;
    s->failed = s->failed || !make_room(s, n);
    if (s->failed) {
        return -1;
    }
    memcpy(s->bytes + s->used, bytes, n);
    s->used += n;
    return 0;
}

char *rpc_dump(const json_t *value, size_t flags, const char *tail, size_t *n) {
    enum { USUAL = 512 };
    sink s = {.bytes = malloc(USUAL), .size = USUAL};
    const size_t layout = flags != 0 ? flags : JSON_COMPACT;
    bool good = value != NULL && s.bytes != NULL &&
                json_dump_callback(value, collect, &s,
                                   layout | JSON_ENSURE_ASCII | JSON_ENCODE_ANY |
                                       JSON_REAL_PRECISION(17)) == 0;
    good = good && !s.failed && collect(tail, strlen(tail) + 1, &s) == 0;
    if (!good) {
        free(s.bytes);
        return NULL;
    }
    if (n != NULL) {
        *n = s.used - 1;
    }
    return s.bytes;
}
