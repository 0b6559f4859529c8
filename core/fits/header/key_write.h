/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/key_write.h: write keywords (cards.h reads them). */
#pragma once

#include <fitsio.h>

/* Write a number with the fewest digits that restore it to the last bit. Write nothing if it is not
 * finite, because FITS has no notation for that. */
void sf_key_write_double(fitsfile *fits, const char *key, double value, const char *comment,
                         int *status);
