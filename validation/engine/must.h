/* SPDX-License-Identifier: GPL-3.0-or-later */
/* must.h: shear-paper ends at its first failure: what is finished is in the result cache, and a
 * second start continues there. */
#ifndef VALIDATION_MUST_H
#define VALIDATION_MUST_H

#include "shear/error.h"

#include <stddef.h>

enum { EXIT_CODE_DONE = 0, EXIT_CODE_OTHER = 1, EXIT_CODE_USAGE = 2 };

/* Where this thread's calls of the libraries leave what went wrong. */
extern _Thread_local shear_error must_error;

/* End the program with the message of must_error unless `code` is SHEAR_OK: exit code 2 for options
 * that are wrong (SHEAR_E_SETTING), else 1. Any thread may call it. */
void must(int code);

/* End the program with this message and advice (or NULL). */
_Noreturn void must_fail(int code, const char *advice, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Zeroed memory of n elements, at least one, for free(); the message says what it is for. */
void *must_allocate(size_t n, size_t size, const char *what);

#endif
