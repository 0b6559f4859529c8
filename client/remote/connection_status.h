/* SPDX-License-Identifier: GPL-3.0-or-later */
/* connection_status.h: how a conversation with the service goes. */
#ifndef CLIENT_REMOTE_CONNECTION_STATUS_H
#define CLIENT_REMOTE_CONNECTION_STATUS_H

#include "sheard/codes.h"

enum connection_status {
    CONNECTION_OK = 0,
    CONNECTION_REFUSED,     /* the service answered with an error; error->code tells */
    CONNECTION_UNREACHABLE, /* no service there, or it is gone */
    CONNECTION_DENIED,      /* we may not connect */
    CONNECTION_MISMATCH,    /* whoever answers does not speak our protocol */
    CONNECTION_SILENT,      /* nothing came in time */
    CONNECTION_INTERRUPTED, /* progress_interrupted() */
    CONNECTION_FAILED       /* our own fault: no memory, a parameter that cannot be sent */
};

/* Fill *error and return `status`. */
enum connection_status connection_fail(sheard_rpc_error *error, enum connection_status status,
                                       const char *advice, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
