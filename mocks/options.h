/* SPDX-License-Identifier: GPL-3.0-or-later */
/* options.h: the part of the option table that spec.c needs, in addition to shear_mocks/mock.h. */
#pragma once

#include "shear_mocks/mock.h"

/* Check every number of the spec against its option's range, every choice against its list. Returns
 * SHEAR_OK, or SHEAR_E_SETTING with a message. */
int options_check_ranges(const shear_mock_spec *s, shear_error *err);
