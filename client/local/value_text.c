/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/value_text.h"

#include "base/text.h"
#include "shear/stamp.h"
#include "terminal/text_line.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

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

char *value_text_length(double from, double to, char *buf, size_t size) {
    if (to > from) {
        snprintf(buf, size, "%.4g to %.4g px", from, to);
    } else {
        snprintf(buf, size, "%.4g px", from);
    }
    return buf;
}

const char *value_text_error_method(const char *name) {
    return strcmp(name, "symmetry") == 0 ? "from the counts of the symmetry" : "delta method";
}

void value_text_print_stamps(int64_t n_used, int64_t n_stamps, const int64_t *flagged, FILE *out) {
    char flags[2048] = "";
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++) {
        if (flagged[bit] > 0) {
            text_append(flags, sizeof flags, "%s%" PRId64 " %s", flags[0] != '\0' ? ", " : " (",
                        flagged[bit], shear_flag_name(bit));
        }
    }
    text_line(out, "stamps", "%" PRId64 " of %" PRId64 " used%s%s", n_used, n_stamps, flags,
              flags[0] != '\0' ? ")" : "");
}
