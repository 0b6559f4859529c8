/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text.h: numbers from text and back. A parser takes the whole text or returns false. */
#ifndef MOCKS_TEXT_H
#define MOCKS_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

bool text_int(const char *text, int *value);
bool text_int64(const char *text, int64_t *value);
bool text_uint64(const char *text, uint64_t *value);
/* Finite numbers only. */
bool text_double(const char *text, double *value);
/* "X,Y" */
bool text_pair(const char *text, double value[2]);
/* "N" = "NxN", or "NXxNY" */
bool text_size(const char *text, int value[2]);
/* "yes" or "no" */
bool text_bool(const char *text, bool *value);
/* The index of `text` in `choices` (NULL-terminated). */
bool text_choice(const char *text, const char *const *choices, int *value);
/* Copy printable ASCII of at most 68 characters, what a FITS string takes. */
bool text_copy(const char *text, char *value, size_t size);

/* The shortest of %.15g, %.16g, %.17g that reads back to the same bits. Returns buf. */
const char *text_of_double(double value, char buf[32]);

#endif
