/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/header/key_write.h"

#include "base/text.h"

#include <math.h>

void sf_key_write_double(fitsfile *fits, const char *key, double value, const char *comment,
                         int *status) {
    if (!isfinite(value))
        return;
    const int digits = text_digits(value, 15);
    fits_write_key_dbl(fits, key, value, -digits, comment, status); /* negative: %G */
}
