/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/file.h: an open FITS file whose HDUs are known. */
#pragma once

#include "fits/header/hdu_index.h"
#include "fits/io/source.h"

typedef struct sf_file {
    sf_source source;
    sf_hdu_index index;
} sf_file;

/* Open a file or a duplicate of `fd`, and index its HDUs. Call sf_file_close after an error,
 * too. */
int sf_file_open(sf_file *f, const char *path, shear_error *err);
int sf_file_open_fd(sf_file *f, int fd, const char *name, shear_error *err);
void sf_file_close(sf_file *f);
