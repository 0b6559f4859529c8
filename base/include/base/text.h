/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/text.h: texts in buffers of a fixed size, and numbers in texts. */
#ifndef BASE_TEXT_H
#define BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The text into buf[size], size > 0; NULL is the empty text. What does not fit is cut off. Returns
 * whether all of it fitted. */
bool text_set(char *buf, size_t size, const char *text);

/* Append to the text in buf[size], as printf does; what does not fit is cut off. Returns whether
 * all of it fitted. */
bool text_append(char *buf, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Append an item of a list: after a ", " unless the list is empty still. */
bool text_append_item(char *buf, size_t size, const char *item);

/* All words, a list ended by NULL: "a, b, c" into buf[size]. */
bool text_list(char *buf, size_t size, const char *const *words);

/* Does it end in `end`, in upper or lower case? */
bool text_ends_with(const char *text, const char *end);

/* The whole text as a decimal number, as strtoll and strtod read it (leading spaces and a sign may
 * be there). False, with *value unchanged, if it is no such number or beyond int64_t. A double may
 * be infinite or NaN. */
bool text_to_int64(const char *text, int64_t *value);
bool text_to_double(const char *text, double *value);

/* The fewest significant digits, at least `least`, with which "%.*g" writes a finite value so that
 * strtod reads the same bits back. At most 17. */
int text_digits(double value, int least);

#endif
