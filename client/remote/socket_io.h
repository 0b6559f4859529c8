/* SPDX-License-Identifier: GPL-3.0-or-later */
/* socket_io.h: a Unix stream socket to the service, with deadlines. The lower half of connection.h.
 */
#ifndef CLIENT_REMOTE_SOCKET_IO_H
#define CLIENT_REMOTE_SOCKET_IO_H

#include "remote/connection_status.h"

#include <stddef.h>

/* *fd is non-blocking and close-on-exec; -1 on errors. */
enum connection_status socket_io_connect(const char *path, double deadline, int *fd,
                                         sheard_rpc_error *error);

/* All of it. If the peer has hung up, the rest is thrown away and CONNECTION_OK returned: what it
 * said before is still to be read. */
enum connection_status socket_io_send(int fd, const char *bytes, size_t n, double deadline,
                                      sheard_rpc_error *error);

/* At least one byte; *n becomes their number. CONNECTION_UNREACHABLE at the end of the stream. */
enum connection_status socket_io_receive(int fd, char *buf, size_t size, size_t *n, double deadline,
                                         sheard_rpc_error *error);

#endif
