/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "shear/error.h"

#include "base/text.h"

#include <stdio.h>
#include <string.h>

static const char *const code_names[] = {
    [SHEAR_OK] = "ok",
    [SHEAR_E_NOMEM] = "out_of_memory",
    [SHEAR_E_IO] = "io",
    [SHEAR_E_FORMAT] = "bad_file",
    [SHEAR_E_SETTING] = "bad_setting",
    [SHEAR_E_BETA] = "beta_too_small",
    [SHEAR_E_PSF] = "bad_psf",
    [SHEAR_E_NEGATIVE] = "negative_pixels",
    [SHEAR_E_EXISTS] = "exists",
    [SHEAR_E_CANCELLED] = "cancelled",
    [SHEAR_E_INTERNAL] = "internal",
    [SHEAR_E_FULL] = "disk_full",
};

const char *shear_code_name(int code) {
    const int n = (int)(sizeof code_names / sizeof code_names[0]);
    return code >= 0 && code < n ? code_names[code] : "unknown";
}

int shear_fail(shear_error *err, int code, const char *advice, const char *format, ...) {
    if (err == NULL)
        return code;
    va_list args;
    va_start(args, format);
    vsnprintf(err->message, sizeof err->message, format, args);
    va_end(args);
    text_set(err->advice, sizeof err->advice, advice);
    err->code = code;
    return code;
}

int shear_prefix(shear_error *err, int code, const char *format, ...) {
    if (err == NULL)
        return code;
    /* Memory for both texts; what does not fit the message is cut off at its end. */
    char joined[2 * sizeof err->message];
    va_list args;
    va_start(args, format);
    vsnprintf(joined, sizeof err->message, format, args);
    va_end(args);
    text_append(joined, sizeof joined, ": %s", err->message);
    joined[sizeof err->message - 1] = '\0';
    memcpy(err->message, joined, sizeof err->message);
    return err->code;
}
