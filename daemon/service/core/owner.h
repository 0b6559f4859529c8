/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/owner.h: refuse to run as root in another user's state directory. */
#pragma once

#include "shear/error.h"

/* Check that root leaves no files in a state directory that belongs to another user, and does not
 * create `installed`, the state directory of the service's user `user` (if that user exists): the
 * installed service could not start any more. SHEAR_E_SETTING with advice; SHEAR_OK for other
 * users, and for root in a directory of its own. */
int owner_check(const char *state_dir, const char *installed, const char *user, shear_error *err);
