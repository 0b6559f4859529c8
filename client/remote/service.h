/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service.h: what all subcommands that talk to the service share: their options, the connection,
 * and errors as messages and exit codes. */
#ifndef CLIENT_REMOTE_SERVICE_H
#define CLIENT_REMOTE_SERVICE_H

#include "cmdline/command.h"
#include "remote/connection.h"

#include <getopt.h>
#include <stdbool.h>

typedef struct service {
    const char *socket;
    bool json;              /* answers as they come, a line each */
    bool utc;               /* times in UTC, not in local time */
    double reply_timeout_s; /* for an answer that needs no waiting */
    connection *connection;
} service;

enum {
    SERVICE_OPT_SOCKET = 2048, /* an option's value of a subcommand is below */
    SERVICE_OPT_JSON,
    SERVICE_OPT_UTC,
    SERVICE_OPT_REPLY_TIMEOUT
};
/* For a subcommand's table of options, and for its help. */
#define SERVICE_OPTIONS                                                                            \
    {"socket", required_argument, NULL, SERVICE_OPT_SOCKET},                                       \
        {"json", no_argument, NULL, SERVICE_OPT_JSON},                                             \
        {"utc", no_argument, NULL, SERVICE_OPT_UTC}, {                                             \
        "reply-timeout", required_argument, NULL, SERVICE_OPT_REPLY_TIMEOUT                        \
    }
#define SERVICE_OPTIONS_HELP                                                                       \
    "  --json                  the service's answers as they come, one JSON object a line\n"       \
    "  --utc                   times in UTC instead of local time\n"                               \
    "  --socket PATH           the service's socket (default: SHEARD_SOCKET in the environment,\n" \
    "                          else " CONNECTION_DEFAULT_SOCKET ")\n"                              \
    "  --reply-timeout TIME    give up on a service that is silent for this long (default 30s)\n"

/* Takes an option of the subcommand's own; returns an exit code, with an error printed. */
typedef int service_handler(int value, void *context);

/* Fill *s from the command line. `options` holds SERVICE_OPTIONS, the subcommand's own and maybe
 * those of settings. Operands are argv[optind] and on. Returns an exit code. */
int service_parse(const command *self, int argc, char **argv, const struct option *options,
                  service_handler *handler, void *context, service *s);
/* The same, with the number of operands checked: from `min` to `max` of what `what` names. */
int service_parse_operands(const command *self, int argc, char **argv, const struct option *options,
                           service_handler *handler, void *context, service *s, const char *what,
                           int min, int max);

/* Connect. Returns an exit code, with an error printed. */
int service_open(service *s);
void service_close(service *s);

/* Ask. Returns an exit code, with an error printed; on EXIT_CODE_DONE give *reply to
 * sheard_reply_deinit. */
int service_call(service *s, int method, const sheard_params *params, sheard_reply *reply);
/* The same, and print the answer where --json was given. */
int service_answer(service *s, int method, const sheard_params *params, sheard_reply *reply);

/* The exit code of a status and its error; service_say prints the error, too. */
int service_exit_code(int status, const sheard_rpc_error *error);
int service_say(int status, const sheard_rpc_error *error);

/* The exit code of a command with several operands: each is tried, and where only some succeed it
 * is EXIT_CODE_PARTLY, else the first failure's. Begin as {0}. */
typedef struct service_tally {
    int n, n_failed, first_code, last_code;
} service_tally;
void service_count(service_tally *tally, int code);
/* False when the service is gone: no sense in asking on. */
bool service_goes_on(const service_tally *tally);
int service_tally_code(const service_tally *tally);

/* A job's number. Returns an exit code, with an error printed. */
int service_job_id(const char *text, int64_t *id);

#endif
