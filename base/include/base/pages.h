/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/pages.h: memory for large arrays. */
#pragma once

#include <stddef.h>

/* Allocate memory that takes room only where it is written to: in huge pages, if the system has
 * them, because a fault for each 4 KiB takes longer than filling them. Aligned to a cache line at
 * least; not zeroed. Free it with free(). NULL if out of memory. */
void *pages_allocate(size_t bytes);
