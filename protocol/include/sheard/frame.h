/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/frame.h: a stream of bytes into lines (docs/protocol.md, "Framing").
 *
 * A line ends with \n; a \r before it is not part of the line; empty lines are not given. What
 * lines come out does not depend on how the bytes were cut into pieces. A line longer than the
 * limit, or with a NUL byte in it, is reported once, at its first byte that is wrong, and skipped
 * to its end: the stream goes on with the next line. At no time is more memory held than the limit
 * (and nothing for lines that arrive in one piece).
 */
#ifndef SHEARD_FRAME_H
#define SHEARD_FRAME_H

#include <stdbool.h>
#include <stddef.h>

enum sheard_frame_event {
    SHEARD_FRAME_MORE = 0, /* all input is used up */
    SHEARD_FRAME_LINE,     /* *line and *length are a line */
    SHEARD_FRAME_TOO_LONG, /* more than `limit` bytes before a \n: this line will be skipped */
    SHEARD_FRAME_NUL,      /* a NUL byte: this line will be skipped */
    SHEARD_FRAME_NOMEM     /* out of memory: this line will be skipped */
};

typedef struct sheard_frame {
    size_t limit; /* longest line, bytes without its \n */
    char *kept;   /* [size] the beginning of a line whose end is to come */
    size_t used, size;
    bool skipping;  /* the rest of the present line is thrown away */
    bool delivered; /* `kept` was given as a line and is free again */
} sheard_frame;

/* `limit` is at least 1. Nothing is allocated. */
void sheard_frame_init(sheard_frame *f, size_t limit);
void sheard_frame_deinit(sheard_frame *f); /* zeroed or deinited: fine */

/* Take bytes from *input (*n of them; both move on) up to the next event, which is returned. Call
 * again until SHEARD_FRAME_MORE; a caller may also stop in between and go on later with the rest.
 * *line is valid until the next call and as long as the input; it has no NUL at its end. */
enum sheard_frame_event sheard_frame_next(sheard_frame *f, const char **input, size_t *n,
                                          const char **line, size_t *length);

/* Bytes held of a line that has not ended: not 0 at the end of a stream that was cut off. */
size_t sheard_frame_pending(const sheard_frame *f);

#endif
