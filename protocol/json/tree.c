/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Avoid two faults of jansson (up to 2.14 at least).
 *
 * 1. Its lexer does not notice if it cannot enlarge the text of a token: bytes are dropped, a value
 * may silently change, and if the dropped byte is a closing quote, it reads and writes beyond its
 * buffers. So its memory is allocated by functions here. While a text is loaded, the first
 * allocation that fails is served from a reserve, and the input ends there. The lexer's buffer
 * grows only when it is given input, and by one doubling at most, for which the reserve is large
 * enough. jansson handles all other failures correctly. The load then fails as out of memory.
 *
 * 2. json_dumps ignores a failure to write a member's name: if memory is scarce, it returns a text
 * without the name. So the bytes are collected here, and a failure is recorded. */
#include "json/tree.h"

#include "base/buffer.h"

#include <assert.h>
#include <stdalign.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct reserve {
    const char *next, *end; /* the rest of the input */
    bool spent;             /* an allocation has failed */
    char *free, *limit;     /* the unused part of `bytes` */
    alignas(max_align_t) char bytes[];
} reserve;

static _Thread_local reserve *active;

static void *from_reserve(reserve *r, size_t n) {
    const size_t unit = alignof(max_align_t);
    r->spent = true;
    if (n > (size_t)(r->limit - r->free))
        return NULL;
    void *p = r->free;
    const size_t rounded = (n + unit - 1) / unit * unit;
    r->free = rounded > (size_t)(r->limit - r->free) ? r->limit : r->free + rounded;
    return p;
}

static void *allocate(size_t n) {
    void *p = malloc(n);
    return p != NULL || active == NULL ? p : from_reserve(active, n);
}

static void release(void *p) {
    const uintptr_t at = (uintptr_t)p;
    if (active != NULL && at >= (uintptr_t)active->bytes && at < (uintptr_t)active->limit)
        return;
    free(p);
}

/* Runs before main, because jansson stores the functions in plain globals: no other thread may be
 * running. */
__attribute__((constructor)) static void install(void) {
    json_set_alloc_funcs(allocate, release);
}

/* Give the lexer one byte at a time, so that it reads nothing after memory ran out. */
static size_t feed(void *bytes, size_t size, void *data) {
    reserve *r = data;
    if (r->spent || r->next == r->end || size == 0)
        return 0;
    *(char *)bytes = *r->next++;
    return 1;
}

static void explain(tree_error *why, const json_error_t *error) {
    why->fault =
        json_error_code(error) == json_error_duplicate_key ? TREE_DUPLICATE_KEY : TREE_SYNTAX;
    snprintf(why->text, sizeof why->text, "%s (line %d, column %d)", error->text, error->line,
             error->column);
}

json_t *tree_load(const char *text, size_t n, size_t flags, tree_error *why) {
    enum { SLACK = 256 };
    *why = (tree_error){TREE_NO_MEMORY, "out of memory"};
    if (n > SIZE_MAX / 4)
        return NULL;
    const size_t spare = 2 * n + SLACK;
    reserve *r = malloc(sizeof *r + spare);
    if (r == NULL)
        return NULL;
    *r = (reserve){.next = text, .end = text + n, .free = r->bytes, .limit = r->bytes + spare};
    assert(active == NULL); /* a nested load would use the other's reserve */
    active = r;
    json_error_t error = {.text = ""};
    json_t *value =
        json_load_callback(feed, r, flags | JSON_REJECT_DUPLICATES | JSON_ALLOW_NUL, &error);
    if (r->spent) {
        json_decref(value);
        value = NULL;
    } else if (value == NULL) {
        explain(why, &error);
    }
    active = NULL;
    free(r);
    return value;
}

static int collect(const char *bytes, size_t n, void *data) {
    return buffer_add(data, bytes, n) ? 0 : -1;
}

char *tree_dump(const json_t *value, size_t flags, const char *tail, size_t *n) {
    enum { ALWAYS = JSON_ENSURE_ASCII | JSON_ENCODE_ANY | JSON_REAL_PRECISION(17) };
    const size_t layout = flags != 0 ? flags : JSON_COMPACT;
    buffer b = {0};
    if (value == NULL || json_dump_callback(value, collect, &b, layout | ALWAYS) != 0 ||
        !buffer_add_text(&b, tail)) {
        buffer_deinit(&b);
        return NULL;
    }
    return buffer_take(&b, n);
}
