/* SPDX-License-Identifier: GPL-3.0-or-later */
/* must.h: error handling of shear-paper, which ends at its first failure: finished chunks are in
 * the result cache, and the next start continues from there. */
#pragma once

#include "base/cleanup.h"
#include "shear/error.h"

#include <stddef.h>

enum { EXIT_CODE_DONE = 0, EXIT_CODE_OTHER = 1, EXIT_CODE_USAGE = 2 };

/* The error of this thread's calls of the libraries. */
extern _Thread_local shear_error must_error;

/* End the program with the message of must_error unless `code` is SHEAR_OK. The exit code is 2 for
 * wrong options (SHEAR_E_SETTING), otherwise 1. Any thread may call this. */
void must(int code);

/* End the program with this message and advice (may be NULL). */
_Noreturn void must_fail(int code, const char *advice, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Return zeroed memory of n elements, at least one, to be freed by the caller. `what` is for the
 * error message. */
void *must_allocate(size_t n, size_t size, const char *what);

/* Set n pointers to zeroed arrays of `size` doubles each, in one allocation: that of the first. */
void must_allocate_arrays(size_t n, double **const arrays[], size_t size, const char *what);
