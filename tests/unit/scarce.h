/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scarce.h: memory that runs out at a chosen moment, for programs linked with
 * -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc (the library's own allocations, not those of the
 * system). */
#pragma once

#include <stdbool.h>

/* The n-th request from now (from 1) is refused; with `ever`, all after it, too. 0: none is. */
void scarce_after(long n, bool ever);
/* Whether a request was refused since scarce_after; and memory is plentiful again. */
bool scarce_end(void);
