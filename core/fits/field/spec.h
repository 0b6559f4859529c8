/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/field/spec.h: check that the reader would accept a field file of this specification. */
#pragma once

#include "fits/io/status.h"
#include "shear/field.h"

/* Check it. SHEAR_E_SETTING names what is wrong; `file` is for messages. */
int sf_field_spec_check(const shear_field_spec *spec, const char *file, shear_error *err);
