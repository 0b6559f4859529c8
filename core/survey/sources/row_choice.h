/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/sources/row_choice.h: which rows of a table are selected, and which are loaded for a chip:
 * a byte per row, so that catalogs may be larger than memory. */
#pragma once

#include "survey/sources/object_tables.h"
#include "survey/sources/source_cap.h"

enum { ROW_SELECTED = 1, ROW_KEPT = 2, ROW_CHUNK = 1 << 16 /* rows that are read at once */ };

typedef struct row_choice {
    const sf_hdu *hdu;      /* of the table; NULL: none yet */
    uint8_t *marks;         /* [its rows] ROW_SELECTED, ROW_KEPT; owned */
    int64_t rows, selected; /* of the chip's extension */
    int64_t kept;
} row_choice;

/* Select rows of a table by the expression (NULL: none), and by FLAGS unless the expression does.
 * This is done once for a table. */
int row_choice_select(row_choice *r, const open_table *t, const char *expression, shear_error *err);
/* Keep the rows of an extension (0: all of the table) that are in the cap; NULL, or no RA and Dec:
 * all. */
int row_choice_keep(row_choice *r, open_table *t, int64_t extension, source_cap *cap,
                    shear_error *err);
/* Return whether any of n rows is kept. */
bool row_choice_any(const row_choice *r, int64_t first, int64_t n);
void row_choice_deinit(row_choice *r);
