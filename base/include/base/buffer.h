/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/buffer.h: a growing array of bytes. A failure is remembered, so that the caller checks once,
 * at the end. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef struct buffer {
    char *bytes; /* [n], without a final NUL unless one was added */
    size_t n, capacity;
    bool failed; /* out of memory: nothing more is added */
} buffer;        /* {0} is empty */

/* Append n bytes. Return !b->failed. */
bool buffer_add(buffer *b, const void *bytes, size_t n);

/* Append a text without its NUL. Return !b->failed. */
bool buffer_add_text(buffer *b, const char *text);

/* Hand over the bytes, with a final NUL that *n (if not NULL) does not count; the buffer is empty
 * then. Return NULL if an addition has failed. The caller frees the bytes. */
char *buffer_take(buffer *b, size_t *n);

void buffer_deinit(buffer *b);
