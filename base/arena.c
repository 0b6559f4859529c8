/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/arena.h"

#include <stdlib.h>
#include <string.h>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/asan_interface.h>
#else
#define ASAN_POISON_MEMORY_REGION(at, bytes) ((void)0)
#endif

enum { CACHE_LINE = 64 };

void *arena_take(arena *a, size_t bytes) {
    char *taken = a->memory != NULL ? a->memory + a->used : NULL;
    const size_t with_gap = (bytes / CACHE_LINE + 1) * CACHE_LINE;
    a->used += with_gap;
    if (taken != NULL)
        ASAN_POISON_MEMORY_REGION(taken + bytes, with_gap - bytes);
    return taken;
}

double *arena_doubles(arena *a, size_t n) {
    return arena_take(a, n * sizeof(double));
}

void *arena_allocate(arena *a) {
    a->memory = aligned_alloc(CACHE_LINE, a->used);
    if (a->memory != NULL)
        memset(a->memory, 0, a->used);
    a->used = 0;
    return a->memory;
}
