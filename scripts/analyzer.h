/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What clang's analyser cannot see, as it looks into one file at a time; included before every file
 * by `scripts/lint --all`, but those that define these functions.
 *
 * Functions that return the code they are given: else it would go on where they return SHEAR_OK. */
#if __has_include("shear/error.h")
#include "shear/error.h"
#define shear_fail(err, code, ...) (shear_fail((err), (code), __VA_ARGS__), (int)(code))
#endif
#if __has_include("fits/io/status.h")
#include "fits/io/status.h"
#define sf_fail(err, code, ...)  (sf_fail((err), (code), __VA_ARGS__), (int)(code))
#define sf_fail_memory(err, ...) (sf_fail_memory((err), __VA_ARGS__), (int)SHEAR_E_NOMEM)
#endif
