/* SPDX-License-Identifier: GPL-3.0-or-later */
/* dial.h: a Unix stream socket to the service, with deadlines. The lower half of connection.h,
 * whose status codes it returns. */
#ifndef CLIENT_REMOTE_SOCKET_IO_H
#define CLIENT_REMOTE_SOCKET_IO_H

#include "remote/connection.h"

#include <stddef.h>

/* Monotonic seconds. A deadline is a time of this clock. */
double socket_io_now(void);

/* *fd is non-blocking and close-on-exec; -1 on errors. */
int socket_io_connect(const char *path, double deadline, int *fd, sheard_rpc_error *error);

/* All of it. Where the peer has hung up, the rest is thrown away and CONNECTION_OK returned: what
 * it said before is still to be read. */
int socket_io_send(int fd, const char *bytes, size_t n, double deadline, sheard_rpc_error *error);

/* At least one byte; *n becomes their number. CONNECTION_UNREACHABLE at the end of the stream. */
int socket_io_receive(int fd, char *buf, size_t size, size_t *n, double deadline,
                 sheard_rpc_error *error);

/* Fill *error and return `status`. */
int connection_fail(sheard_rpc_error *error, int status, const char *advice, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
