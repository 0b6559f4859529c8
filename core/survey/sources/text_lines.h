/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/sources/text_lines.h: read a text line by line. */
#pragma once

#include "fits/io/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct text_lines {
    int fd;
    sf_place at;
    int64_t offset;              /* in the file, of the bytes to be read next */
    char *bytes;                 /* [capacity + 1] */
    size_t capacity, begin, end; /* bytes [begin, end) have been read, but not returned */
    bool at_end;
    int64_t number; /* of the line returned last, from 1 */
} text_lines;

/* Begin to read descriptor `fd`, whose position is not used; lines have at most `longest` bytes.
 * SHEAR_E_NOMEM. Call text_lines_deinit after an error, too. */
int text_lines_init(text_lines *l, int fd, sf_place at, size_t longest, shear_error *err);
void text_lines_deinit(text_lines *l);

/* Begin again. */
void text_lines_rewind(text_lines *l);

/* Read the next line, without its end; *line is valid until the next call, and NULL at the end of
 * the file. SHEAR_E_FORMAT: it is too long, or has a zero byte; SHEAR_E_IO. */
int text_lines_next(text_lines *l, char **line, shear_error *err);
