/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/array.h"

#include <assert.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { LEAST_BYTES = 64 };

size_t array_next_capacity(size_t capacity, size_t needed, size_t item_size) {
    assert(item_size > 0);
    const size_t least = item_size < LEAST_BYTES ? LEAST_BYTES / item_size : 1;
    const size_t doubled = capacity > SIZE_MAX / 2 ? SIZE_MAX : 2 * capacity;
    const size_t larger = doubled > least ? doubled : least;
    return larger > needed ? larger : needed;
}

bool array_reserve_exact(void *items, size_t *capacity, size_t needed, size_t item_size) {
    void *old =
        NULL; /* copied, because a pointer to another type must not be read as a void pointer */
    memcpy(&old, items, sizeof old);
    if (needed <= *capacity)
        return true;
    void *grown = needed <= SIZE_MAX / item_size ? realloc(old, needed * item_size) : NULL;
    if (grown == NULL)
        return false;
    memcpy(items, &grown, sizeof grown);
    *capacity = needed;
    return true;
}

bool array_reserve(void *items, size_t *capacity, size_t needed, size_t item_size) {
    const size_t larger = array_next_capacity(*capacity, needed, item_size);
    return needed <= *capacity || array_reserve_exact(items, capacity, larger, item_size);
}

size_t array_lower_bound(const void *items, size_t n, size_t item_size, const void *key,
                         int (*compare)(const void *key, const void *item)) {
    size_t low = 0;
    while (low < n) {
        const size_t middle = low + (n - low) / 2;
        if (compare(key, (const char *)items + middle * item_size) > 0) {
            low = middle + 1;
        } else {
            n = middle;
        }
    }
    return low;
}
