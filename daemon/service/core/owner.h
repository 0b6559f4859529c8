/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/owner.h: whose state directory is it? */
#ifndef SHEARD_SERVICE_OWNER_H
#define SHEARD_SERVICE_OWNER_H

#include "shear/error.h"

/* Root must not leave files in another user's state directory, nor make the one where the service
 * of the user `user` (if there is one on this system) would look for its own, `installed`: that
 * service could not start any more. SHEAR_E_SETTING with advice; SHEAR_OK for everybody else, and
 * for root in a directory of its own. */
int owner_check(const char *state_dir, const char *installed, const char *user, shear_error *err);

#endif
