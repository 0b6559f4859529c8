/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service_query.h: a subcommand that is one question without parameters and operands. */
#ifndef CLIENT_REMOTE_SERVICE_QUERY_H
#define CLIENT_REMOTE_SERVICE_QUERY_H

#include "remote/service.h"

/* Returns an exit code. `print` is called unless --json was given. */
int service_query(const command *self, int method, void (*print)(const sheard_reply *reply),
                  int argc, char **argv);

#endif
