/* SPDX-License-Identifier: GPL-3.0-or-later */
/* connection_status.h: the result of a request to the service. */
#pragma once

#include "sheard/codes.h"

enum connection_status {
    CONNECTION_OK = 0,
    CONNECTION_REFUSED,     /* the service replied with an error: error->code */
    CONNECTION_UNREACHABLE, /* no service listens, or it has closed the connection */
    CONNECTION_DENIED,      /* no permission to connect */
    CONNECTION_MISMATCH,    /* the peer does not speak this protocol or version */
    CONNECTION_SILENT,      /* no reply within the timeout */
    CONNECTION_INTERRUPTED, /* progress_interrupted() */
    CONNECTION_FAILED       /* out of memory, or a parameter that cannot be sent */
};

/* Fill *error, and return `status`. */
enum connection_status connection_fail(sheard_rpc_error *error, enum connection_status status,
                                       const char *advice, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
