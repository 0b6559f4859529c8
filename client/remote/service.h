/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service.h: what all subcommands that talk to the service share: their options, the connection,
 * and errors as messages and exit codes. */
#ifndef CLIENT_REMOTE_SERVICE_H
#define CLIENT_REMOTE_SERVICE_H

#include "remote/connection.h"

#include "cmdline/options.h"

#include <stdbool.h>

typedef struct service {
    const char *socket;
    bool json;              /* answers as they come, a line each */
    bool utc;               /* times in UTC, not in local time */
    double reply_timeout_s; /* for an answer that needs no waiting */
    connection *connection;
} service;

/* Options of every subcommand that talks to the service, and their help. */
#define SERVICE_OPTIONS(s)                                                                         \
    {.name = "socket", .text = &(s)->socket}, {.name = "json", .flag = &(s)->json},                \
        {.name = "utc", .flag = &(s)->utc}, {                                                      \
        .name = "reply-timeout", .set = service_set_reply_timeout, .context = (s)                  \
    }
enum exit_code service_set_reply_timeout(const option_entry *entry, const char *value);
#define SERVICE_OPTIONS_HELP                                                                       \
    "  --json                  the service's answers as they come, one JSON object a line\n"       \
    "  --utc                   times in UTC instead of local time\n"                               \
    "  --socket PATH           the service's socket (default: SHEARD_SOCKET in the environment,\n" \
    "                          else " CONNECTION_DEFAULT_SOCKET ")\n"                              \
    "  --reply-timeout TIME    give up on a service that is silent for this long (default 30s)\n"
#define SERVICE_EXIT_CODES_HELP                                                                    \
    "exit status: 0 done, 2 usage, 3 no such file, job or field, 4 some of several failed,\n"      \
    "7 the service cannot be reached, 1 anything else"

/* Options at their defaults, not connected. */
void service_init(service *s);
/* service_init, and fill *s and what else `entries` name from the command line, with from `min` to
 * `max` operands of what `what` names. Returns an exit code, with an error printed. */
enum exit_code service_parse(const command *self, int argc, char **argv,
                             const option_entry *entries, service *s, const char *what, int min,
                             int max);
/* The same, and connect. */
enum exit_code service_start(const command *self, int argc, char **argv,
                             const option_entry *entries, service *s, const char *what, int min,
                             int max);

/* Connect. Returns an exit code, with an error printed. */
enum exit_code service_open(service *s);
void service_close(service *s);

/* Ask. Returns an exit code, with an error printed; on EXIT_CODE_DONE give *reply to
 * sheard_reply_deinit. */
enum exit_code service_call(service *s, int method, const sheard_params *params,
                            sheard_reply *reply);
/* The same, and print the answer where --json was given. */
enum exit_code service_answer(service *s, int method, const sheard_params *params,
                              sheard_reply *reply);

/* The exit code of an enum connection_status and its error; service_say prints the error, too. */
enum exit_code service_exit_code(enum connection_status status, const sheard_rpc_error *error);
enum exit_code service_say(enum connection_status status, const sheard_rpc_error *error);

/* What a subcommand with several operands exits with: each is tried, and if only some succeed it is
 * EXIT_CODE_PARTLY, else the first failure's. Begin with {0}. */
typedef struct service_outcomes {
    int n, n_failed;
    enum exit_code first, last; /* the first failure's, the last operand's */
} service_outcomes;
void service_outcomes_add(service_outcomes *o, enum exit_code code);
/* False when the service is gone: it makes no sense to ask on. */
bool service_outcomes_go_on(const service_outcomes *o);
enum exit_code service_outcomes_code(const service_outcomes *o);

/* A job's number. Returns an exit code, with an error printed. */
enum exit_code service_job_id(const char *text, int64_t *id);

#endif
