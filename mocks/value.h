/* SPDX-License-Identifier: GPL-3.0-or-later */
/* value.h: values of options from text and back. A parser takes the whole text or returns false. */
#ifndef MOCKS_VALUE_H
#define MOCKS_VALUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

bool value_int(const char *text, int *value);
bool value_int64(const char *text, int64_t *value);
bool value_uint64(const char *text, uint64_t *value);
/* Finite numbers only. */
bool value_double(const char *text, double *value);
/* "X,Y" */
bool value_pair(const char *text, double value[2]);
/* "N" = "NxN", or "NXxNY" */
bool value_size(const char *text, int value[2]);
/* "yes" or "no" */
bool value_bool(const char *text, bool *value);
/* The index of `text` in `choices` (NULL-terminated). */
bool value_choice(const char *text, const char *const *choices, int *value);
/* Copy printable ASCII of at most 68 characters, what a FITS string takes. */
bool value_copy(const char *text, char *value, size_t size);

/* The shortest of %.15g, %.16g, %.17g that reads back to the same bits. Returns buf. */
const char *value_of_double(double value, char buf[32]);

#endif
