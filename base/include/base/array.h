/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/array.h: grow an array on the heap that has a length and a capacity, and search a sorted
 * one. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Reserve memory for `needed` items in all: `items` is a pointer variable (NULL at first),
 * `capacity` a size_t variable (0 at first). The capacity doubles, so that appending item by item
 * costs constant time per item. Return false if out of memory; nothing has changed then.
 *
 *     if (!ARRAY_RESERVE(list->items, list->capacity, list->n + 1)) {
 *         return false;
 *     }
 *     list->items[list->n++] = item;
 *
 * For two arrays with one capacity, reserve the first with a copy of the capacity. */
#define ARRAY_RESERVE(items, capacity, needed)                                                     \
    array_reserve((void *)&(items), &(capacity), (needed), sizeof *(items))

/* The same for scratch memory: reserve exactly what is needed. */
#define ARRAY_RESERVE_EXACT(items, capacity, needed)                                               \
    array_reserve_exact((void *)&(items), &(capacity), (needed), sizeof *(items))

/* The functions behind the macros; `items` is the address of the pointer. */
bool array_reserve(void *items, size_t *capacity, size_t needed, size_t item_size);
bool array_reserve_exact(void *items, size_t *capacity, size_t needed, size_t item_size);

/* Return the capacity that follows `capacity` and holds `needed` items, at least 64 bytes: for
 * arrays with limits of their own. */
size_t array_next_capacity(size_t capacity, size_t needed, size_t item_size);

/* Return the index of the first of items[n] that does not come before the key, or n if all do. The
 * items are sorted by `compare`, which is called as by bsearch: with the key and an item. */
size_t array_lower_bound(const void *items, size_t n, size_t item_size, const void *key,
                         int (*compare)(const void *key, const void *item));
