/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/keys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool absent(int status) {
    return status == KEY_NO_EXIST || status == VALUE_UNDEFINED;
}

int sf_key_double(fitsfile *fits, sf_place at, const char *key, double *value, bool *found,
                  shear_error *err) {
    int status = 0;
    double v = NAN;
    char text[FLEN_VALUE] = "";
    fits_read_keyword(fits, key, text, NULL, &status);
    fits_read_key(fits, TDOUBLE, key, &v, NULL, &status);
    *found = status == 0;
    if (status != 0) {
        fits_clear_errmsg();
    }
    if (absent(status)) {
        return SHEAR_OK;
    }
    if (status != 0 || !isfinite(v) || text[0] == '\'') { /* CFITSIO would take '12 px' for 12 */
        return sf_fail(err, SHEAR_E_FORMAT, at, "correct the keyword, or leave it out",
                       "keyword %s is not a finite number", key);
    }
    *value = v;
    return SHEAR_OK;
}

int sf_key_int(fitsfile *fits, sf_place at, const char *key, int64_t min, int64_t max,
               int64_t *value, bool *found, shear_error *err) {
    double v = 0.0; /* read as a double, because CFITSIO would cut 2.5 to 2 */
    const int rc = sf_key_double(fits, at, key, &v, found, err);
    if (rc != SHEAR_OK || !*found) {
        return rc;
    }
    if (v != floor(v) || v < (double)min || v > (double)max) {
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL,
                       "keyword %s is %.15g, but must be an integer from %lld to %lld", key, v,
                       (long long)min, (long long)max);
    }
    *value = (int64_t)v;
    return SHEAR_OK;
}

int sf_key_string(fitsfile *fits, sf_place at, const char *key, char **text, shear_error *err) {
    int status = 0;
    char *found = NULL;
    *text = NULL;
    fits_read_key_longstr(fits, key, &found, NULL, &status);
    if (status != 0) {
        fits_clear_errmsg();
    }
    if (status == 0 && found != NULL) {
        *text = strdup(found);
    }
    const bool lost = status == 0 && found != NULL && *text == NULL;
    int ignored = 0;
    if (found != NULL) {
        fits_free_memory(found, &ignored);
    }
    if (lost) {
        return sf_fail_memory(err, at);
    }
    if (status != 0 && !absent(status)) {
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "keyword %s cannot be read as a string", key);
    }
    return SHEAR_OK;
}

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
