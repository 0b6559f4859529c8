/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What clang's analyser cannot see, as it looks into one file at a time; included before every file
 * by `scripts/lint --all`, but those that define these functions.
 *
 * Functions that return the code they are given: else it would go on where they return SHEAR_OK. */
#if __has_include("shear/error.h")
#include "shear/error.h"
#define shear_fail(err, code, ...) ((void)(err), (int)(code))
#endif
#if __has_include("fits/io/status.h")
#include "fits/io/status.h"
#define sf_fail(err, code, ...)  ((void)(err), (int)(code))
#define sf_fail_memory(err, ...) ((void)(err), (int)SHEAR_E_NOMEM)
#endif

/* It does not know that a local with a cleanup attribute is read at the end of its block. */
#if __has_include("base/cleanup.h")
#include "base/cleanup.h"
#undef CLEANUP_TAKE
#define CLEANUP_TAKE(pointer) (pointer)
#endif
