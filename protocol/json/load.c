/* SPDX-License-Identifier: GPL-3.0-or-later */
/* jansson up to at least 2.14 does not notice when its lexer cannot grow the text of a token: bytes
 * are dropped, a value may silently change, and where the dropped byte is a closing quote it reads
 * and writes beyond its buffers. So its allocations come through here. While a text is loaded, the
 * first request that the system cannot serve is served from a reserve, and the input ends there:
 * the lexer's buffer grows only when it is fed, and by one doubling at most, which the reserve
 * holds. All else it does with a NULL is right. The load then fails as out of memory. */
#include "json/load.h"

#include <stdalign.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct reserve {
    const char *next, *end; /* input that is to come */
    bool spent;             /* the system had no memory */
    char *free, *limit;     /* what is left of `bytes` */
    alignas(max_align_t) char bytes[];
} reserve;

static _Thread_local reserve *active;

static void *from_reserve(reserve *r, size_t n) {
    const size_t unit = alignof(max_align_t);
    r->spent = true;
    if (n > (size_t)(r->limit - r->free)) {
        return NULL;
    }
    void *p = r->free;
    const size_t rounded = (n + unit - 1) / unit * unit;
    r->free = rounded > (size_t)(r->limit - r->free) ? r->limit : r->free + rounded;
    return p;
}

static void *take(size_t n) {
    void *p = malloc(n);
    return p != NULL || active == NULL ? p : from_reserve(active, n);
}

static void give_back(void *p) {
    const uintptr_t at = (uintptr_t)p;
    if (active != NULL && at >= (uintptr_t)active->bytes && at < (uintptr_t)active->limit) {
        return;
    }
    free(p);
}

/* Before main, since jansson keeps the functions in plain globals: no thread may be running. */
__attribute__((constructor)) static void install(void) {
    json_set_alloc_funcs(take, give_back);
}

/* One byte at a time, so that nothing is read after memory ran out. */
static size_t feed(void *buffer, size_t size, void *data) {
    reserve *r = data;
    if (r->spent || r->next == r->end || size == 0) {
        return 0;
    }
    *(char *)buffer = *r->next++;
    return 1;
}

static void explain(rpc_load_error *why, const json_error_t *error) {
    why->code = json_error_code(error) == json_error_duplicate_key ? SHEARD_RPC_DUPLICATE_KEY
                                                                   : SHEARD_RPC_PARSE_ERROR;
    snprintf(why->text, sizeof why->text, "%s (line %d, column %d)", error->text, error->line,
             error->column);
}

json_t *rpc_load(const char *text, size_t n, size_t flags, rpc_load_error *why) {
    *why = (rpc_load_error){SHEARD_RPC_OUT_OF_MEMORY, "out of memory"};
    enum { SLACK = 256 };
    if (n > SIZE_MAX / 4) {
        return NULL;
    }
    const size_t spare = 2 * n + SLACK;
    reserve *r = malloc(sizeof *r + spare);
    if (r == NULL) {
        return NULL;
    }
    *r = (reserve){.next = text, .end = text + n, .free = r->bytes, .limit = r->bytes + spare};
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
