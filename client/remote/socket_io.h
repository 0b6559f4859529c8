/* SPDX-License-Identifier: GPL-3.0-or-later */
/* socket_io.h: a Unix stream socket to the service, with deadlines: the transport of connection.h.
 */
#pragma once

#include "remote/connection_status.h"

#include <stddef.h>

/* Connect to the socket `path`. *fd becomes non-blocking and close-on-exec; -1 on errors. */
enum connection_status socket_io_connect(const char *path, double deadline, int *fd,
                                         sheard_rpc_error *error);

/* Send all n bytes. If the peer has hung up, drop the rest and return CONNECTION_OK: a reply sent
 * before may still be readable. */
enum connection_status socket_io_send(int fd, const char *bytes, size_t n, double deadline,
                                      sheard_rpc_error *error);

/* Receive at least one byte; *n becomes their number. Returns CONNECTION_UNREACHABLE at the end of
 * the stream. */
enum connection_status socket_io_receive(int fd, char *buf, size_t size, size_t *n, double deadline,
                                         sheard_rpc_error *error);
