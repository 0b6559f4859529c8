/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/key_write.h: writing keywords. (Reading them: cards.h.) */
#ifndef SHEAR_FITS_HEADER_KEY_WRITE_H
#define SHEAR_FITS_HEADER_KEY_WRITE_H

#include <fitsio.h>

/* Write a number with as few digits as give it back to the last bit; nothing where it is not
 * finite, which FITS cannot say. */
void sf_key_write_double(fitsfile *fits, const char *key, double value, const char *comment,
                         int *status);

#endif
