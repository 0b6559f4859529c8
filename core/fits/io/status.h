/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/io/status.h: errors of core/fits: every message begins with "file '...', HDU ...: ". */
#pragma once

#include "shear/error.h"

/* The place of an error. `hdu` is NULL for the whole file. */
typedef struct sf_place {
    const char *file;
    const char *hdu;
} sf_place;

int sf_fail(shear_error *err, int code, sf_place at, const char *advice, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Fail unless a CFITSIO status is 0: "...: <doing>: <CFITSIO's message>". A failure clears
 * CFITSIO's message stack, which is global. Memory and write failures have their own codes;
 * everything else is SHEAR_E_FORMAT. */
int sf_check_status(shear_error *err, sf_place at, int status, const char *doing);

/* Fail with an errno: SHEAR_E_IO, SHEAR_E_FULL or SHEAR_E_NOMEM. */
int sf_fail_errno(shear_error *err, sf_place at, int number, const char *doing);

int sf_fail_memory(shear_error *err, sf_place at);

/* Replace all that is not printable ASCII by '?'. */
void sf_make_printable(char *text);
