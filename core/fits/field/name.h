/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/field/name.h: check the names of fields, which are used in protocols and reports, and make
 * them from names of files. */
#pragma once

#include "fits/io/status.h"
#include "shear/field.h"

/* Check that `name` is 1 to 71 printable ASCII characters without a blank at either end, and copy
 * it. `whence` is its origin, for the message. Return `code` on error. */
int sf_field_name_copy(char out[SHEAR_FIELD_NAME_SIZE], const char *name, int code, sf_place at,
                       const char *whence, shear_error *err);

/* The same for a file's base name without .gz, .fz and .fits. SHEAR_E_FORMAT. */
int sf_field_name_of_file(char out[SHEAR_FIELD_NAME_SIZE], const char *path, sf_place at,
                          shear_error *err);
