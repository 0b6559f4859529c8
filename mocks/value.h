/* SPDX-License-Identifier: GPL-3.0-or-later */
/* value.h: conversion of option values from and to text. A parser accepts the whole text or returns
 * false. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Parse a decimal integer in the range of the type. */
bool value_int(const char *text, int *value);
bool value_int64(const char *text, int64_t *value);
bool value_uint64(const char *text, uint64_t *value);
/* Parse a finite number. */
bool value_double(const char *text, double *value);
/* Parse "yes" or "no". */
bool value_bool(const char *text, bool *value);
/* Copy at most 68 characters of printable ASCII, the limit of a FITS string. */
bool value_copy(const char *text, char *value, size_t size);

/* Write the shortest of %.15g, %.16g, %.17g that reads back to the same bits. Returns buf. */
const char *value_of_double(double value, char buf[32]);
