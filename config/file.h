/* SPDX-License-Identifier: GPL-3.0-or-later */
/* file.h: a small file as a whole. */
#ifndef CONFIG_FILE_H
#define CONFIG_FILE_H

#include "shear/error.h"

#include <stdbool.h>
#include <stddef.h>

enum { CONFIG_FILE_MAX = 1 << 20 }; /* bytes */

/* *text is malloc'd, the caller's, and not terminated; NULL if the file is not there and
 * `may_miss`. SHEAR_E_IO for what cannot be read, is not a regular file or is larger than
 * CONFIG_FILE_MAX; SHEAR_E_NOMEM. */
int file_read(const char *path, bool may_miss, char **text, size_t *size, shear_error *err);

#endif
