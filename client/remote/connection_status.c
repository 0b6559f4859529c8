/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/connection_status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum connection_status connection_fail(sheard_rpc_error *error, enum connection_status status,
                                       const char *advice, const char *format, ...) {
    memset(error, 0, sizeof *error);
    error->code = SHEARD_RPC_UNKNOWN;
    snprintf(error->advice, sizeof error->advice, "%s", advice != NULL ? advice : "");
    va_list args;
    va_start(args, format);
    vsnprintf(error->message, sizeof error->message, format, args);
    va_end(args);
    return status;
}
