/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service_query.h: subcommands that are one question, or one for each job of the command line. */
#ifndef CLIENT_REMOTE_SERVICE_QUERY_H
#define CLIENT_REMOTE_SERVICE_QUERY_H

#include "remote/service.h"

/* Prints an answer; not called with --json. */
typedef void service_printer(const sheard_reply *reply, const service *s);

/* A question without parameters and operands. Returns an exit code. */
enum exit_code service_query(const command *self, int argc, char **argv, int method,
                             service_printer *print);

/* A question for each job; `what` the operands are. Returns an exit code. */
enum exit_code service_query_jobs(const command *self, int argc, char **argv, const char *what,
                                  int method, service_printer *print);
/* A printer's part: how a job is after cancel, retry and retract. */
void service_query_print_job(const sheard_msg_job *job);

#endif
