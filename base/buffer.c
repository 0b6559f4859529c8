/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/buffer.h"

#include "base/array.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

bool buffer_add(buffer *b, const void *bytes, size_t n) {
    b->failed = b->failed || n > SIZE_MAX - b->n || !ARRAY_RESERVE(b->bytes, b->capacity, b->n + n);
    if (b->failed)
        return false;
    if (n > 0) { /* bytes may be NULL */
        memcpy(b->bytes + b->n, bytes, n);
    }
    b->n += n;
    return true;
}

bool buffer_add_text(buffer *b, const char *text) {
    return buffer_add(b, text, strlen(text));
}

char *buffer_take(buffer *b, size_t *n) {
    if (!buffer_add(b, "", 1)) {
        buffer_deinit(b);
        return NULL;
    }
    char *bytes = b->bytes;
    if (n != NULL)
        *n = b->n - 1;
    *b = (buffer){0};
    return bytes;
}

void buffer_deinit(buffer *b) {
    free(b->bytes);
    *b = (buffer){0};
}
