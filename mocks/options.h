/* SPDX-License-Identifier: GPL-3.0-or-later */
/* options.h: what spec.c needs of the option table beside shear_mocks/mock.h. */
#ifndef MOCKS_OPTIONS_H
#define MOCKS_OPTIONS_H

#include "shear_mocks/mock.h"

/* Every number of the spec against its option's range, every choice against its list. */
int options_check_ranges(const shear_mock_spec *s, shear_error *err);

#endif
