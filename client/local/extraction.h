/* SPDX-License-Identifier: GPL-3.0-or-later */
/* extraction.h: copy a field, whatever it is read from, into one field file, which measures to the
 * same bits. */
#pragma once

#include "shear/field.h"
#include "terminal/progress.h"

/* Write the open field to `path`. `name` overrides its name, unless NULL. SHEAR_E_EXISTS if the
 * file exists and `overwrite` is false; SHEAR_E_CANCELLED if the progress bar says so. */
int extraction_write(shear_field *field, const char *path, const char *name, bool overwrite,
                     progress *bar, shear_error *err);
