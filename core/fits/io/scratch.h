/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/io/scratch.h: temporary files for what has been unpacked or converted. */
#pragma once

#include "fits/io/status.h"

/* Open an empty file without a name in $TMPDIR (or /tmp), or take the next of those passed to
 * shear_field_use_scratch. *out is a descriptor, which the caller closes. SHEAR_E_IO, SHEAR_E_FULL.
 */
int sf_scratch_open(sf_place at, int *out, shear_error *err);
