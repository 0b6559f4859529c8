/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/out_queue.h: lines on their way to a client. */
#ifndef SHEARD_SERVER_OUT_QUEUE_H
#define SHEARD_SERVER_OUT_QUEUE_H

#include <stdbool.h>
#include <stddef.h>

/* A line. A notification is one line, however many clients it goes to. */
typedef struct out_line {
    size_t references;
    size_t n;
    char *bytes;    /* [n] */
    size_t *memory; /* where its bytes are counted as long as it lives; NULL: nowhere */
} out_line;

/* Takes `bytes` (malloc'd) over, also on failure. NULL: out of memory, or bytes is NULL. The caller
 * has one reference. */
out_line *out_line_new(char *bytes, size_t n);
void out_line_unref(out_line *line); /* NULL is fine */

/* Count it there, too, as long as it lives. */
void out_line_count(out_line *line, size_t *memory);

/* A ring of lines, the oldest first. */
typedef struct out_queue {
    out_line **items; /* [capacity] */
    size_t first, n, capacity;
    size_t bytes; /* of all of them, less what has been written of the oldest */
    size_t written;
    size_t held; /* memory of this queue alone: whole lines, without those counted elsewhere */
} out_queue;

void out_queue_deinit(out_queue *q); /* may be zeroed */
/* Takes a reference of its own. False: out of memory. */
bool out_queue_push(out_queue *q, out_line *line);
out_line *out_queue_at(const out_queue *q, size_t i); /* i < n */
/* So many bytes, from the oldest on, have been written; lines that are done with are released. */
void out_queue_consume(out_queue *q, size_t bytes);

#endif
