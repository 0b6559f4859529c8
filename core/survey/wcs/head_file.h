/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/wcs/head_file.h: a text file of header cards (SCAMP's .head): blocks that end with END,
 * one per chip, which replace the coordinates of the chips' headers. */
#pragma once

#include "shear/error.h"

#include <stdint.h>

typedef struct head_file {
    char *cards;    /* [first[n]][80], those of coordinates only; owned */
    int64_t *first; /* [n + 1] number of the first card of each block; owned */
    int n;
} head_file;
/* Read the file at `path`, or the descriptor fd if it is not negative. SHEAR_E_IO, SHEAR_E_NOMEM;
 * SHEAR_E_FORMAT: it is no text of cards, a block has no END or no CTYPE1. Call head_file_deinit
 * after an error, too. */
int head_file_init(head_file *h, const char *path, int fd, shear_error *err);
void head_file_deinit(head_file *h);
/* Return a copy of the image's header [*count][80], all its coordinates replaced by those of block
 * `i`; NULL: out of memory. The caller frees it. */
char *head_file_merge(const head_file *h, int i, const char *cards, int64_t *count);
