/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/frame.h: split a stream of bytes into lines (docs/protocol.md, "Framing").
 *
 * A line ends with \n; a \r before it is not part of the line; empty lines are skipped. The lines
 * do not depend on how the bytes were split into pieces. A line longer than the limit, or with a
 * NUL byte, is reported once, at its first wrong byte, and skipped to its end: the stream continues
 * with the next line. Memory is allocated only for lines that arrive in several pieces, and never
 * more than the limit. */
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
    size_t limit; /* longest line in bytes, without its \n */
    char *kept;   /* [size] the beginning of an incomplete line */
    size_t used, size;
    bool skipping;  /* the rest of the current line is skipped */
    bool delivered; /* `kept` has been returned as a line, and may be reused */
} sheard_frame;

/* Initialize; `limit` is at least 1. Nothing is allocated. */
void sheard_frame_init(sheard_frame *f, size_t limit);
void sheard_frame_deinit(sheard_frame *f); /* a zeroed or deinited struct is accepted */

/* Take bytes from *input (*n of them; both are advanced) up to the next event, and return it. Call
 * it again until SHEARD_FRAME_MORE; a caller may also continue with the rest later. *line is valid
 * until the next call and as long as the input. It is not terminated. */
enum sheard_frame_event sheard_frame_next(sheard_frame *f, const char **input, size_t *n,
                                          const char **line, size_t *length);

/* Return the bytes held of an incomplete line. At the end of a stream, not 0 means that the last
 * line is incomplete. */
size_t sheard_frame_pending(const sheard_frame *f);

#endif
