/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/io/status.h: errors of this room: every message begins with "file '...', HDU ...: ". */
#ifndef SHEAR_FITS_IO_STATUS_H
#define SHEAR_FITS_IO_STATUS_H

#include "shear/error.h"

/* Where something went wrong. `hdu` is NULL where the whole file is meant. */
typedef struct sf_place {
    const char *file;
    const char *hdu;
} sf_place;

int sf_fail(shear_error *err, int code, sf_place at, const char *advice, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* From a CFITSIO status: "...: <doing>: <CFITSIO's words>". Clears CFITSIO's message stack, which
 * is global. Memory and write failures get their own codes, everything else is SHEAR_E_FORMAT. */
int sf_fail_status(shear_error *err, sf_place at, int status, const char *doing);

/* From errno: SHEAR_E_IO, SHEAR_E_FULL or SHEAR_E_NOMEM. */
int sf_fail_errno(shear_error *err, sf_place at, int number, const char *doing);

int sf_fail_memory(shear_error *err, sf_place at);

#endif
