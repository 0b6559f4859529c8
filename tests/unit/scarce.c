/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scarce.h"

#include <stddef.h>

void *__real_malloc(size_t n);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *p, size_t n);
void *__wrap_malloc(size_t n);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *p, size_t n);

static long left;
static bool for_ever, refused;

void scarce_after(long n, bool ever) {
    left = n;
    for_ever = ever;
    refused = false;
}

bool scarce_end(void) {
    left = 0;
    return refused;
}

static bool refuse(void) {
    if (left == 0 || --left > 0)
        return false;
    left = for_ever ? 1 : 0;
    refused = true;
    return true;
}

void *__wrap_malloc(size_t n) {
    return refuse() ? NULL : __real_malloc(n);
}

void *__wrap_calloc(size_t n, size_t size) {
    return refuse() ? NULL : __real_calloc(n, size);
}

void *__wrap_realloc(void *p, size_t n) {
    return refuse() ? NULL : __real_realloc(p, n);
}
