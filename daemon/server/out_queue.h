/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines on their way to a client. */
#ifndef SERVER_OUT_H
#define SERVER_OUT_H

#include <stdbool.h>
#include <stddef.h>

/* A line. A notification is one text, however many clients it goes to. */
typedef struct out_text {
    size_t references;
    size_t n;
    char *bytes;    /* [n] */
    size_t *memory; /* where its bytes are counted as long as it lives; NULL: nowhere */
} out_text;

/* Takes `bytes` (malloc'd) over, also on failure. NULL: out of memory, or bytes is NULL. The caller
 * has one reference. */
out_text *out_text_new(char *bytes, size_t n);
void out_text_drop(out_text *text); /* NULL is fine */

/* Count it there, too, as long as it lives. */
void out_text_count(out_text *text, size_t *memory);

/* A ring of texts, the oldest first. */
typedef struct out_queue {
    out_text **items; /* [size] */
    size_t first, n, size;
    size_t bytes; /* of all of them, less what has been written of the oldest */
    size_t written;
    size_t
        held; /* memory that is this queue's alone: whole texts, without those counted elsewhere */
} out_queue;

void out_queue_deinit(out_queue *q); /* zeroed: fine */
/* Takes a reference of its own. False: out of memory. */
bool out_queue_push(out_queue *q, out_text *text);
out_text *out_queue_at(const out_queue *q, size_t i); /* i < n */
/* So many bytes, from the oldest on, have been written; texts that are done with are dropped. */
void out_queue_take(out_queue *q, size_t bytes);

#endif
