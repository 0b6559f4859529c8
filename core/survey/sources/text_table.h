/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/sources/text_table.h: convert SExtractor's ASCII_HEAD catalogs to FITS, so that all
 * catalogs are read in one way.
 *
 * Lines "#  NUMBER NAME  description [unit]" name the columns; of a vector only the first number is
 * listed, so that its width is the next line's number minus its own. Rows of numbers, separated by
 * blanks, follow. Other lines that begin with # are comments. */
#pragma once

#include "fits/io/status.h"

#include <stdint.h>

enum {
    TEXT_TABLE_LINE = 1 << 20, /* bytes of a line, at most */
    TEXT_TABLE_VALUES = 100000 /* numbers of a row, at most */
};

/* Convert the text in descriptor `fd`, whose position is not used, to a FITS file of one table with
 * at most `most_rows`; columns are doubles, or integers of 32 or 64 bits if all their values are;
 * *out is an unnamed file, which the caller closes. SHEAR_E_FORMAT: no such text; what is wrong,
 * and in which line. SHEAR_E_IO, SHEAR_E_FULL, SHEAR_E_NOMEM. */
int text_table_convert(int fd, sf_place at, int64_t most_rows, int *out, shear_error *err);
