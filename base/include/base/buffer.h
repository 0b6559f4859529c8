/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/buffer.h: bytes that are appended to. A failure is kept, so that it is tested once, at the
 * end. */
#ifndef BASE_BUFFER_H
#define BASE_BUFFER_H

#include <stdbool.h>
#include <stddef.h>

typedef struct buffer {
    char *bytes; /* [n], not ended by NUL unless one was added */
    size_t n, capacity;
    bool failed; /* memory was out: nothing more is added */
} buffer;        /* {0} is empty */

/* Returns !b->failed. */
bool buffer_add(buffer *b, const void *bytes, size_t n);

/* The text without its NUL. */
bool buffer_add_text(buffer *b, const char *text);

/* Hand over the bytes, ended by a NUL that *n (if not NULL) does not count; the buffer is empty
 * then. NULL when it has failed. The caller frees. */
char *buffer_take(buffer *b, size_t *n);

void buffer_deinit(buffer *b);

#endif
