/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/growth.h: grow marked pixels by a disc, a row at a time.
 *
 * A row of the disc at distance d from its centre is as wide as 2 w + 1 pixels, with w^2 <= r^2 -
 * d^2. The rows of marks are united by their w first, and widened once. */
#pragma once

#include "base/arena.h"

#include <stdint.h>

enum { GROWTH_MOST = 4 }; /* the largest radius, pixels */

/* One grown row in the making; the memory is an arena's. */
typedef struct growth {
    int n;                           /* pixels of a row */
    uint8_t *reach[GROWTH_MOST + 1]; /* [n + 2 GROWTH_MOST] marks to be widened by w, from x = -
                                        GROWTH_MOST */
} growth;

void growth_place(growth *g, int n, arena *a);
/* Begin another row. */
void growth_begin(growth *g);
/* Add the marks (1 or 0) of a row at distance d from the grown one, `row` being its pixel number
 * -GROWTH_MOST; radius <= GROWTH_MOST. A row that is farther adds nothing. */
void growth_add(growth *g, const uint8_t *row, int d, int radius);
/* Write the grown row, out[n]. */
void growth_finish(const growth *g, uint8_t *restrict out);
