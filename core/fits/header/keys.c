/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/header/keys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

void sf_write_double(fitsfile *fits, const char *key, double value, const char *comment,
                     int *status) {
    if (!isfinite(value)) {
        return;
    }
    char text[40];
    int digits = 15;
    do {
        snprintf(text, sizeof text, "%.*G", digits, value);
    } while (strtod(text, NULL) != value && ++digits < 17);
    fits_write_key_dbl(fits, key, value, -digits, comment, status); /* negative: %G */
}
