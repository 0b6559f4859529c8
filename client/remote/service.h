/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service.h: shared by all subcommands that connect to the service: their options, the connection,
 * error messages and exit codes. */
#pragma once

#include "remote/connection.h"

#include "cmdline/options.h"

#include <stdbool.h>

typedef struct service {
    const char *socket;
    bool json;              /* print replies as received, one per line */
    bool utc;               /* times in UTC instead of local time */
    double reply_timeout_s; /* for a reply that needs no waiting */
    connection *connection;
} service;

/* Options of every subcommand that connects to the service, and their help. */
#define SERVICE_OPTIONS(s)                                                                         \
    {.name = "socket", .text = &(s)->socket}, {.name = "json", .flag = &(s)->json},                \
        {.name = "utc", .flag = &(s)->utc}, {                                                      \
        .name = "reply-timeout", .set = service_set_reply_timeout, .context = (s)                  \
    }
enum exit_code service_set_reply_timeout(const option_entry *entry, const char *value);

/* Set the default options; not connected. */
void service_init(service *s);
/* Call service_init, then parse the command line into *s and the other `entries`, with `min` to
 * `max` operands, which `what` names. Returns an exit code; on failure an error has been printed.
 */
enum exit_code service_parse(const command *self, int argc, char **argv,
                             const option_entry *entries, service *s, const char *what, int min,
                             int max);
/* Do the same, then connect. */
enum exit_code service_start(const command *self, int argc, char **argv,
                             const option_entry *entries, service *s, const char *what, int min,
                             int max);

/* Connect. Returns an exit code; on failure an error has been printed. */
enum exit_code service_open(service *s);
void service_close(service *s);

/* Send a request and wait for the reply. Returns an exit code; on failure an error has been
 * printed. *reply and *text are as in connection_call. */
enum exit_code service_call(service *s, int method, const sheard_params *params,
                            sheard_reply *reply, char **text);
/* Do the same, and print the reply if --json was given. */
enum exit_code service_answer(service *s, int method, const sheard_params *params,
                              sheard_reply *reply);

/* Print the error unless the status is CONNECTION_OK. Returns its exit code. */
enum exit_code service_say(enum connection_status status, const sheard_rpc_error *error);

/* Parse a job's number. Returns an exit code; on failure an error has been printed. */
enum exit_code service_job_id(const char *text, int64_t *id);
