/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/out_queue.h"

#include "base/array.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* Lines for which an empty queue keeps memory. */
enum { SMALL = 16 };

out_line *out_line_new(char *bytes, size_t n) {
    out_line *line = bytes != NULL ? malloc(sizeof *line) : NULL;
    if (line == NULL) {
        free(bytes);
        return NULL;
    }
    *line = (out_line){.references = 1, .n = n, .bytes = bytes};
    return line;
}

void out_line_count(out_line *line, size_t *memory) {
    line->memory = memory;
    *memory += line->n;
}

void out_line_unref(out_line *line) {
    if (line != NULL && --line->references == 0) {
        if (line->memory != NULL)
            *line->memory -= line->n;
        free(line->bytes);
        free(line);
    }
}

void out_queue_deinit(out_queue *q) {
    out_queue_consume(q, q->bytes);
    free(q->items);
    *q = (out_queue){0};
}

out_line *out_queue_at(const out_queue *q, size_t i) {
    assert(i < q->n);
    return q->items[q->first + i];
}

bool out_queue_push(out_queue *q, out_line *line) {
    if (q->first > q->n) { /* so that a line is moved once at most, on average */
        memmove(q->items, q->items + q->first, q->n * sizeof(out_line *));
        q->first = 0;
    }
    if (!ARRAY_RESERVE(q->items, q->capacity, q->first + q->n + 1))
        return false;
    line->references++;
    q->items[q->first + q->n++] = line;
    q->bytes += line->n;
    q->held += line->memory != NULL ? 0 : line->n;
    return true;
}

static void pop(out_queue *q) {
    out_line *line = q->items[q->first++];
    q->n--;
    q->written -= line->n;
    q->held -= line->memory != NULL ? 0 : line->n;
    out_line_unref(line);
}

void out_queue_consume(out_queue *q, size_t bytes) {
    assert(bytes <= q->bytes);
    q->bytes -= bytes;
    q->written += bytes;
    while (q->n > 0 && q->written >= out_queue_at(q, 0)->n)
        pop(q);
    if (q->n == 0 && q->capacity > SMALL) {
        free(q->items);
        q->items = NULL;
        q->capacity = q->first = 0;
    }
}
