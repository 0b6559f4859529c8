/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/error.h
 * How every call of libshear reports failure.
 *
 * A function that can fail returns an int: SHEAR_OK (0), or another value of enum shear_code. The
 * same code, a message that names what was wrong (file, HDU, stamp, key, expected value) and advice
 * (what to do about it) are written to the caller's shear_error. Every parameter `shear_error *err`
 * may be NULL. A bad galaxy is never an error: it is a flag in its row (shear/stamp.h).
 */
#ifndef SHEAR_ERROR_H
#define SHEAR_ERROR_H

#include "shear/linkage.h"

#include <stdarg.h>

SHEAR_BEGIN_C

/** What went wrong. */
enum shear_code {
    SHEAR_OK = 0,       /**< nothing */
    SHEAR_E_NOMEM = 1,  /**< out of memory */
    SHEAR_E_IO = 2,     /**< the system could not open, read or write */
    SHEAR_E_FORMAT = 3, /**< the file, or the arrays, are not a valid field */
    /** A setting is unknown, ill-typed, out of range or contradicts another. */
    SHEAR_E_SETTING = 4,
    SHEAR_E_BETA = 5,      /**< the target PSF is too narrow for this PSF and sampling */
    SHEAR_E_PSF = 6,       /**< the PSF image is unusable (not finite, no flux, no peak) */
    SHEAR_E_NEGATIVE = 7,  /**< negative pixels for a log interpolation without a pedestal */
    SHEAR_E_EXISTS = 8,    /**< the output exists and must not be replaced */
    SHEAR_E_CANCELLED = 9, /**< the caller's callback requested a stop */
    SHEAR_E_INTERNAL = 10, /**< a call that violates its contract, or a bug in libshear */
    SHEAR_E_FULL = 11      /**< a disk that was to be written to is full */
};

/** The description of a failed call, owned by the caller. */
typedef struct shear_error {
    int code;          /**< enum shear_code */
    char message[480]; /**< one line, no full stop needed, NUL-terminated */
    char advice[240];  /**< what to do; may be empty */
} shear_error;

/** Return the stable lower-case name of a code ("ok", "bad_file", ...), for protocols and scripts;
 * "unknown" for any other number. */
const char *shear_code_name(int code);

/** Fill *err (if not NULL) and return `code`. The advice may be NULL; `format` is as in printf. */
int shear_fail(shear_error *err, int code, const char *advice, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/** Put "prefix: " before the message that *err already holds (to add the file's name, say). Return
 * err->code, or `code` if err is NULL. */
int shear_prefix(shear_error *err, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

SHEAR_END_C

#endif
