/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service_query.h: subcommands that send a request, or one per job on the command line, and print
 * the reply. */
#pragma once

#include "remote/service.h"

/* Print a reply. Not called with --json. */
typedef void service_printer(const sheard_reply *reply, const service *s);

/* Send a request and print the reply, as JSON or by `print`. Returns an exit code. */
enum exit_code service_ask(service *s, int method, const sheard_params *params,
                           service_printer *print);

/* What such a subcommand does, as its command.data. */
typedef struct service_query {
    int method;
    service_printer *print;
    const char *jobs; /* what its operands, numbers of jobs, are called; NULL: it has none */
} service_query;
/* The command.run of all these subcommands. */
enum exit_code service_query_run(const command *self, int argc, char **argv);
