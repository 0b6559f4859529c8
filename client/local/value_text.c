/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/value_text.h"

#include <math.h>
#include <stdio.h>

/* Shears are compared at the level of 1e-5, even if the error of a single field is larger. */
enum { MIN_DECIMALS = 5, MAX_DECIMALS = 12 };

int value_text_decimals(double error) {
    if (!isfinite(error) || error <= 0.0)
        return 6;
    int decimals = 1 - (int)floor(log10(error));
    return decimals < MIN_DECIMALS   ? MIN_DECIMALS
           : decimals > MAX_DECIMALS ? MAX_DECIMALS
                                     : decimals;
}

char *value_text(double value, double error, char *buf, size_t size) {
    const int decimals = value_text_decimals(error);
    if (isfinite(value)) {
        snprintf(buf, size, "%+.*f +- %.*f", decimals, value, decimals, error);
    } else {
        snprintf(buf, size, "-");
    }
    return buf;
}
