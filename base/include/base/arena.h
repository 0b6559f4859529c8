/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/arena.h: one allocation for many arrays, and the number of its bytes before it is made.
 *
 * The function that places the arrays is called twice: with an arena without memory, which only
 * counts, and with memory for what was counted.
 *
 *     static void place(thing *t, size_t n, arena *a) {
 *         t->x = arena_doubles(a, n);
 *         t->index = arena_take(a, n * sizeof *t->index);
 *     }
 *
 *     arena a = {0};
 *     place(t, n, &a);
 *     t->memory = arena_allocate(&a); // the caller frees it
 *     if (t->memory == NULL)
 *         return false;
 *     place(t, n, &a); */
#pragma once

#include <stddef.h>

typedef struct arena {
    char *memory; /* NULL: it counts */
    size_t used;  /* bytes */
} arena;

/* Return the next `bytes` of the memory, zeros aligned to a cache line; NULL if the arena counts.
 * There is a gap of at least a byte after them, so that arrays whose sizes are powers of two do not
 * share cache sets. */
void *arena_take(arena *a, size_t bytes);
double *arena_doubles(arena *a, size_t n);

/* Allocate what has been counted, for the same arrays to be taken again. NULL if out of memory. */
void *arena_allocate(arena *a);
