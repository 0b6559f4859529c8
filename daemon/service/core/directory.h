/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/directory.h: make a directory if it is missing, and refuse to run as root in
 * another user's state directory. */
#pragma once

#include "shear/error.h"

#include <sys/types.h>

/* Make the directory, unless it exists. SHEAR_E_IO. */
int directory_make(const char *path, mode_t mode, shear_error *err);
/* Check that root leaves no files in a state directory that belongs to another user, and does not
 * create `installed`, the state directory of the service's user `user` (if that user exists): the
 * installed service could not start any more. SHEAR_E_SETTING with advice; SHEAR_OK for other
 * users, and for root in a directory of its own. */
int directory_check_owner(const char *state_dir, const char *installed, const char *user,
                          shear_error *err);
