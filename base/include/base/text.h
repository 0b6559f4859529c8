/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/text.h: texts in buffers of fixed size, numbers in texts, and lines for terminals. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Copy the text into buf[size], size > 0; NULL is the empty text. What does not fit is cut off.
 * Return whether all of it fitted. */
bool text_set(char *buf, size_t size, const char *text);

/* Append to the text in buf[size], as printf does; what does not fit is cut off. Return whether all
 * of it fitted. */
bool text_append(char *buf, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Append an item to a list, after a ", " unless the list is empty. Return whether all of it
 * fitted. */
bool text_append_item(char *buf, size_t size, const char *item);

/* Write the words, an array ended by NULL, as "a, b, c" into buf[size]. Return whether all of it
 * fitted. */
bool text_list(char *buf, size_t size, const char *const *words);

/* Return whether `text` ends in `end`, ignoring case. */
bool text_ends_with(const char *text, const char *end);

/* Parse the whole text as a decimal number, as strtoll and strtod do (with leading spaces and a
 * sign). Return false, with *value unchanged, if it is not a number or is beyond int64_t. A double
 * may be infinite or NaN. */
bool text_to_int64(const char *text, int64_t *value);
bool text_to_double(const char *text, double *value);

/* Parse true, yes, on or 1, or false, no, off or 0. Return false, with *value unchanged, if it is
 * none of them. */
bool text_to_bool(const char *text, bool *value);

/* Return the fewest significant digits, from `least` to 17, with which "%.*g" writes a finite value
 * so that strtod reads the same bits back. */
int text_digits(double value, int least);

enum { TEXT_COLUMNS = 78 }; /* of a line */

/* Print the words of `text` from column `column` on, and end the line. Further lines begin with
 * `indent`. */
void text_wrap(FILE *out, const char *text, int column, const char *indent);
