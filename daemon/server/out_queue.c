/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/out_queue.h"

#include <stdlib.h>

/* A queue that is empty keeps no more than this. */
enum { SMALL = 16 };

out_text *out_text_new(char *bytes, size_t n) {
    out_text *text = bytes != NULL ? malloc(sizeof *text) : NULL;
    if (text == NULL) {
        free(bytes);
        return NULL;
    }
    *text = (out_text){.references = 1, .n = n, .bytes = bytes};
    return text;
}

void out_text_count(out_text *text, size_t *memory) {
    text->memory = memory;
    *memory += text->n;
}

void out_text_drop(out_text *text) {
    if (text != NULL && --text->references == 0) {
        if (text->memory != NULL) {
            *text->memory -= text->n;
        }
        free(text->bytes);
        free(text);
    }
}

void out_queue_deinit(out_queue *q) {
    out_queue_take(q, q->bytes);
    free(q->items);
    *q = (out_queue){0};
}

out_text *out_queue_at(const out_queue *q, size_t i) {
    return q->items[(q->first + i) % q->size];
}

static bool grow(out_queue *q) {
    const size_t size = q->size != 0 ? 2 * q->size : SMALL;
    out_text **items = malloc(size * sizeof(out_text *));
    if (items == NULL) {
        return false;
    }
    for (size_t i = 0; i < q->n; i++) {
        items[i] = out_queue_at(q, i);
    }
    free(q->items);
    q->items = items;
    q->size = size;
    q->first = 0;
    return true;
}

bool out_queue_push(out_queue *q, out_text *text) {
    if (q->n == q->size && !grow(q)) {
        return false;
    }
    text->references++;
    q->items[(q->first + q->n++) % q->size] = text;
    q->bytes += text->n;
    q->held += text->memory != NULL ? 0 : text->n;
    return true;
}

static void pop(out_queue *q) {
    out_text *text = q->items[q->first];
    q->first = (q->first + 1) % q->size;
    q->n--;
    q->written -= text->n;
    q->held -= text->memory != NULL ? 0 : text->n;
    out_text_drop(text);
}

void out_queue_take(out_queue *q, size_t bytes) {
    q->bytes -= bytes;
    q->written += bytes;
    while (q->n > 0 && q->written >= out_queue_at(q, 0)->n) {
        pop(q);
    }
    if (q->n == 0 && q->size > SMALL) {
        free(q->items);
        q->items = NULL;
        q->size = q->first = 0;
    }
}
