/* SPDX-License-Identifier: GPL-3.0-or-later */
/* input_path.h: file names on the command line: absolute paths, and the HDU of "FILE:HDU". */
#pragma once

#include "shear/error.h"
#include "shear/input.h"

#include <stddef.h>

/* Set *path to the absolute path of `name`, malloc'd, to be freed by the caller. A relative name
 * becomes the real path of its directory and its last component. That one may be a symbolic link,
 * which is kept: the service decides what it opens. Returns SHEAR_OK, SHEAR_E_IO (no such
 * directory) or SHEAR_E_NOMEM. */
int input_path_absolute(const char *name, char **path, shear_error *err);

/* Parse "FILE:HDU": set the HDU number or name in *part, and *length to the length of FILE in
 * bytes. part->path stays NULL; part->extname points into `name`. If there is no HDU, or a file is
 * called `name` including the colon, *length is the length of `name`. Returns SHEAR_OK, or
 * SHEAR_E_SETTING if the number or the length of the HDU's name is out of range. */
int input_path_hdu(const char *name, shear_input_part *part, size_t *length, shear_error *err);
