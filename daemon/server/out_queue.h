/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/out_queue.h: lines that wait to be written to a client. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* A line, with a count of its references. A notification to several clients is one line. */
typedef struct out_line {
    size_t references;
    size_t n;
    char *bytes;    /* [n] */
    size_t *memory; /* counter that includes the line's bytes while it lives, or NULL */
} out_line;

/* Create a line, with one reference for the caller. `bytes` (from malloc) is taken over, also on
 * failure. Return NULL if out of memory or if bytes is NULL. */
out_line *out_line_new(char *bytes, size_t n);
void out_line_unref(out_line *line); /* NULL is accepted */

/* Count the line's bytes in *memory for as long as it lives. */
void out_line_count(out_line *line, size_t *memory);

/* Lines, the oldest first. */
typedef struct out_queue {
    out_line **items; /* [capacity], in use: [first, first + n) */
    size_t first, n, capacity;
    size_t bytes; /* of all lines, without the written part of the oldest */
    size_t written;
    size_t held; /* bytes of whole lines, without those counted elsewhere */
} out_queue;

void out_queue_deinit(out_queue *q); /* a zeroed queue is accepted */
/* Append a line, with a reference of its own. Return false if out of memory. */
bool out_queue_push(out_queue *q, out_line *line);
out_line *out_queue_at(const out_queue *q, size_t i); /* i < n */
/* Remove `bytes` written bytes, the oldest first, and release the lines that are complete. */
void out_queue_consume(out_queue *q, size_t bytes);
