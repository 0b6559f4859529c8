/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/io/status.h"

#include <errno.h>
#include <fitsio.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const char full_advice[] = "the disk is full: make room and try again";

int sf_fail(shear_error *err, int code, sf_place at, const char *advice, const char *format, ...) {
    char text[sizeof((shear_error *)0)->message];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (at.hdu != NULL)
        return shear_fail(err, code, advice, "file '%s', HDU %s: %s", at.file, at.hdu, text);
    return shear_fail(err, code, advice, "file '%s': %s", at.file, text);
}

static bool means_full(int number) {
    return number == ENOSPC || number == EDQUOT;
}

/* CFITSIO does not report why a write failed; `number` is the errno that the system call left. */
static int code_of(int status, int number) {
    switch (status) {
    case MEMORY_ALLOCATION:
        return SHEAR_E_NOMEM;
    case WRITE_ERROR:
    case FILE_NOT_CREATED:
    case FILE_NOT_CLOSED:
        return means_full(number) ? SHEAR_E_FULL : SHEAR_E_IO;
    case TOO_MANY_FILES:
        return SHEAR_E_IO;
    default:
        return SHEAR_E_FORMAT;
    }
}

void sf_make_printable(char *text) {
    for (char *c = text; *c != '\0'; c++) {
        if (*c < ' ' || *c > '~')
            *c = '?';
    }
}

int sf_check_status(shear_error *err, sf_place at, int status, const char *doing) {
    if (status == 0)
        return SHEAR_OK;
    char text[FLEN_STATUS] = "";
    char detail[FLEN_ERRMSG] = "";
    const int number = errno;
    fits_get_errstatus(status, text);
    /* The oldest message is closest to the cause; later ones name the callers. */
    if (fits_read_errmsg(detail) == 0)
        detail[0] = '\0';
    fits_clear_errmsg();
    sf_make_printable(detail);
    const int code = code_of(status, number);
    const char *advice = code == SHEAR_E_IO     ? "check the disk's free space and permissions"
                         : code == SHEAR_E_FULL ? full_advice
                                                : NULL;
    return sf_fail(err, code, at, advice, "%s: %s%s%s%s", doing, text,
                   detail[0] != '\0' ? " (" : "", detail, detail[0] != '\0' ? ")" : "");
}

static const char *advice_of(int number) {
    switch (number) {
    case ENOENT:
        return "check the path";
    case EACCES:
    case EPERM:
        return "check the permissions of the file and its directories";
    case ENOSPC:
    case EDQUOT:
        return full_advice;
    case EMFILE:
    case ENFILE:
        return "too many open files: raise the limit (ulimit -n) or open fewer at once";
    default:
        return NULL;
    }
}

int sf_fail_errno(shear_error *err, sf_place at, int number, const char *doing) {
    char text[128];
    const char *words = strerror_r(number, text, sizeof text);
    const int code = number == ENOMEM     ? SHEAR_E_NOMEM
                     : means_full(number) ? SHEAR_E_FULL
                                          : SHEAR_E_IO;
    return sf_fail(err, code, at, advice_of(number), "%s: %s", doing, words);
}

int sf_fail_memory(shear_error *err, sf_place at) {
    return sf_fail(err, SHEAR_E_NOMEM, at, NULL, "out of memory");
}
