/* SPDX-License-Identifier: GPL-3.0-or-later */
/* memory.h: zeroed memory in a chain of calls that stops at the first failure. */
#ifndef VALIDATION_MEMORY_H
#define VALIDATION_MEMORY_H

#include "shear/error.h"

#include <stddef.h>

/* n elements, at least one, for free(). Nothing (NULL) where *code is not SHEAR_OK; without memory
 * *code becomes SHEAR_E_NOMEM, and the message says what for. */
void *memory_new(size_t n, size_t size, const char *what, int *code, shear_error *err);

#endif
