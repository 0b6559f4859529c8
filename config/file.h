/* SPDX-License-Identifier: GPL-3.0-or-later */
/* file.h: read a small file as a whole. */
#pragma once

#include "shear/error.h"

#include <stdbool.h>
#include <stddef.h>

enum { CONFIG_FILE_MAX = 1 << 20 }; /* bytes */

/* Read the file into *text, which the caller frees; it is not terminated. If the file does not
 * exist and `may_miss` is true, *text is NULL. Return SHEAR_OK; SHEAR_E_IO if the file cannot be
 * read, is not a regular file or exceeds CONFIG_FILE_MAX; or SHEAR_E_NOMEM. */
int file_read(const char *path, bool may_miss, char **text, size_t *size, shear_error *err);
