/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/file.h: a surveyed file, and CFITSIO handles on its HDUs. */
#ifndef SHEAR_FITS_FILE_H
#define SHEAR_FITS_FILE_H

#include "fits/source.h"
#include "fits/survey.h"

#include <fitsio.h>

typedef struct sf_file {
    sf_source source;
    sf_survey survey;
} sf_file;

int sf_file_open(sf_file *f, const char *path, shear_error *err);
int sf_file_open_fd(sf_file *f, int fd, const char *name, shear_error *err);
/* Also after a failed open. */
void sf_file_close(sf_file *f);

/* A handle of its own on one HDU, so that no header is parsed again when reading changes from one
 * HDU to another. *fits is NULL on error; close it with sf_close_hdu. */
int sf_open_hdu(const sf_file *f, int number, const char *label, fitsfile **fits, shear_error *err);
void sf_close_hdu(fitsfile *fits);

#endif
