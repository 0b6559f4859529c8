/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/rows.h: the bytes of a table's rows. */
#pragma once

#include "fits/io/status.h"

#include <stdint.h>

typedef struct sf_rows {
    int fd;        /* of the table's file, borrowed */
    sf_place at;   /* for messages; its texts are borrowed */
    int64_t start; /* of the first row in the file */
    int64_t width; /* bytes of a row */
} sf_rows;

/* Read `bytes` bytes of row `row`, from `offset` in the row. SHEAR_E_IO, SHEAR_E_FORMAT: the file
 * has become shorter. */
int sf_rows_bytes(const sf_rows *r, int64_t row, int64_t offset, int64_t bytes, void *out,
                  shear_error *err);
