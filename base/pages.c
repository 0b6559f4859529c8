/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/pages.h"

#include <stdlib.h>
#include <sys/mman.h>

static const size_t huge_page = (size_t)2 << 20;

void *pages_allocate(size_t bytes) {
    const size_t whole = (bytes / huge_page + 1) * huge_page;
    void *memory = aligned_alloc(huge_page, whole);
    if (memory != NULL)
        (void)madvise(memory, whole, MADV_HUGEPAGE); /* only advice: kernels may lack them */
    return memory;
}
