/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service_query.h: subcommands that send a single request, or one per job on the command line. */
#pragma once

#include "remote/service.h"

/* Print a reply. Not called with --json. */
typedef void service_printer(const sheard_reply *reply, const service *s);

/* Send a request without parameters. Returns an exit code. */
enum exit_code service_query(const command *self, int argc, char **argv, int method,
                             service_printer *print);

/* Send a request for each job on the command line; `what` names the operands. Returns an exit code.
 */
enum exit_code service_query_jobs(const command *self, int argc, char **argv, const char *what,
                                  int method, service_printer *print);
/* Print the state of a job after cancel, retry or retract. For printers. */
void service_query_print_job(const sheard_msg_job *job);
