/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/sources/catalog_file.h: open a catalog file, FITS or SExtractor's ASCII_HEAD, either of
 * them gzipped or not, as FITS. */
#pragma once

#include "fits/header/file.h"

/* Open `path`, or the descriptor fd if it is not negative. SHEAR_E_IO, SHEAR_E_FORMAT,
 * SHEAR_E_FULL, SHEAR_E_NOMEM. Call sf_file_close after an error, too. */
int catalog_file_open(sf_file *file, const char *path, int fd, shear_error *err);
