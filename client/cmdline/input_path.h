/* SPDX-License-Identifier: GPL-3.0-or-later */
/* input_path.h: names of files as the user types them, and as the service wants them. */
#ifndef CLIENT_CMDLINE_INPUT_PATH_H
#define CLIENT_CMDLINE_INPUT_PATH_H

#include "shear/error.h"
#include "shear/input.h"

#include <stddef.h>

/* The absolute path of `name`: a relative one is put behind the real path of its directory; its
 * last part stays as it is, even if it is a symbolic link (the service decides what it opens).
 * *path is malloc'd. SHEAR_E_IO (no such directory), SHEAR_E_NOMEM. */
int input_path_absolute(const char *name, char **path, shear_error *err);

/* The HDU of "FILE:HDU", a number or a name, into *part (whose path stays NULL; extname points into
 * `name`), and in *length the bytes of FILE; all bytes if there is none. A file that has this
 * very name is meant as it is. SHEAR_E_SETTING: the number or the name's length is out of range. */
int input_path_hdu(const char *name, shear_input_part *part, size_t *length, shear_error *err);

#endif
