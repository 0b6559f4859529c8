/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/pages.h"

#include <stdbool.h>
#include <stdlib.h>
#include <sys/mman.h>

static const size_t huge_page = (size_t)2 << 20;
static const size_t cache_line = 64;

void *pages_allocate(size_t bytes) {
    const bool large = bytes >= 4 * huge_page; /* less would waste some of the last one */
    const size_t unit = large ? huge_page : cache_line;
    const size_t whole = (bytes / unit + 1) * unit;
    void *memory = aligned_alloc(unit, whole);
    if (memory != NULL && large)
        (void)madvise(memory, whole, MADV_HUGEPAGE); /* only advice: kernels may lack them */
    return memory;
}
