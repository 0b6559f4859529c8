/* SPDX-License-Identifier: GPL-3.0-or-later */
/* style.h: colours on a terminal, and the width of text in columns. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Escape sequences. A style is one of these, or NULL for none. */
#define STYLE_BOLD   "\x1b[1m"
#define STYLE_DIM    "\x1b[2m"
#define STYLE_GOOD   "\x1b[32m"
#define STYLE_BAD    "\x1b[31m"
#define STYLE_DOUBT  "\x1b[33m"
#define STYLE_ACTIVE "\x1b[36m"
#define STYLE_END    "\x1b[0m"

/* Return whether `fd` is a terminal that can move its cursor. */
bool style_is_terminal(int fd);
/* Return whether `out` is a terminal with colours, and the user wants them (NO_COLOR is unset or
 * empty). */
bool style_on(FILE *out);

/* Return the number of columns of the terminal `fd`, from 20 to 400; `otherwise` if it is not a
 * terminal. */
int style_columns(int fd, int otherwise);
int style_rows(int fd, int otherwise);

/* Return the columns that `text` takes, without escape sequences. An invalid byte takes 1. */
int style_width(const char *text);
/* Return how many bytes of `text` fit into `columns`, escape sequences included. */
size_t style_fit(const char *text, int columns);
