/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/service.h"

#include "cmdline/options.h"
#include "terminal/human.h"
#include "terminal/message.h"

#include <errno.h>
#include <stdlib.h>

static const double default_reply_timeout_s = 30.0;

static int set_reply_timeout(const char *text, double *seconds) {
    if (!human_parse_duration(text, seconds) || *seconds <= 0.0) {
        message_fail(NULL, "--reply-timeout %s: expected a time, as 30, 500ms, 2min", text);
        return EXIT_CODE_USAGE;
    }
    return EXIT_CODE_DONE;
}

static int take(int value, service *s) {
    switch (value) {
    case SERVICE_OPT_SOCKET:
        s->socket = optarg;
        return EXIT_CODE_DONE;
    case SERVICE_OPT_JSON:
        s->json = true;
        return EXIT_CODE_DONE;
    case SERVICE_OPT_UTC:
        s->utc = true;
        return EXIT_CODE_DONE;
    default:
        return set_reply_timeout(optarg, &s->reply_timeout_s);
    }
}

int service_parse(const command *self, int argc, char **argv, const struct option *options,
                  service_handler *handler, void *context, service *s) {
    *s = (service){.socket = connection_default_path(), .reply_timeout_s = default_reply_timeout_s};
    opterr = 0;
    int value = 0;
    int code = EXIT_CODE_DONE;
    while (code == SHEAR_OK && (value = getopt_long(argc, argv, ":", options, NULL)) != -1) {
        if (value == '?' || value == ':') {
            code = options_bad(self, value, argv, options);
        } else if (value >= SERVICE_OPT_SOCKET && value <= SERVICE_OPT_REPLY_TIMEOUT) {
            code = take(value, s);
        } else {
            code = handler(value, context);
        }
    }
    return code;
}

int service_parse_operands(const command *self, int argc, char **argv, const struct option *options,
                           service_handler *handler, void *context, service *s, const char *what,
                           int min, int max) {
    const int code = service_parse(self, argc, argv, options, handler, context, s);
    if (code != SHEAR_OK) {
        return code;
    }
    const int n = argc - optind;
    if (n < min) {
        message_fail(NULL, "%s: which %s? \"shearctl help %s\" tells more", self->name, what,
                     self->name);
        return EXIT_CODE_USAGE;
    }
    if (n > max) {
        message_fail(NULL, "%s: unexpected \"%s\"", self->name, argv[optind + max]);
        return EXIT_CODE_USAGE;
    }
    return EXIT_CODE_DONE;
}

/* An error that the service answered with. */
static int refused(int code) {
    switch (code) {
    case SHEARD_RPC_BAD_PARAMETER:
    case SHEARD_RPC_MISSING_PARAMETER:
    case SHEARD_RPC_UNKNOWN_PARAMETER:
    case SHEARD_RPC_DUPLICATE_KEY:
    case SHEARD_RPC_PARSE_ERROR:
    case SHEARD_RPC_TOO_COMPLEX:
    case SHEARD_RPC_LINE_TOO_LONG:
    case SHEARD_RPC_BAD_SETTING:
    case SHEARD_RPC_BAD_CURSOR:
        return EXIT_CODE_USAGE;
    case SHEARD_RPC_OUTSIDE_ROOTS:
    case SHEARD_RPC_NOT_READABLE:
    case SHEARD_RPC_NO_SUCH_FILE:
    case SHEARD_RPC_NOT_REGULAR:
    case SHEARD_RPC_BAD_FILE:
    case SHEARD_RPC_NO_SUCH_JOB:
    case SHEARD_RPC_NO_SUCH_FIELD:
        return EXIT_CODE_INPUT;
    case SHEARD_RPC_UNKNOWN_METHOD:
    case SHEARD_RPC_UNSUPPORTED_VERSION:
    case SHEARD_RPC_STOPPING:
    case SHEARD_RPC_TOO_MANY_CONNECTIONS:
    case SHEARD_RPC_IDLE_TIMEOUT:
    case SHEARD_RPC_BAD_REPLY:
        return EXIT_CODE_UNREACHABLE;
    default:
        return EXIT_CODE_OTHER;
    }
}

int service_exit_code(int status, const sheard_rpc_error *error) {
    switch (status) {
    case CONNECTION_OK:
        return EXIT_CODE_DONE;
    case CONNECTION_REFUSED:
        return refused(error->code);
    case CONNECTION_UNREACHABLE:
    case CONNECTION_DENIED:
    case CONNECTION_MISMATCH:
    case CONNECTION_SILENT:
        return EXIT_CODE_UNREACHABLE;
    default:
        return EXIT_CODE_OTHER;
    }
}

int service_say(int status, const sheard_rpc_error *error) {
    if (status != CONNECTION_OK) {
        message_fail(error->advice[0] ? error->advice : NULL, "%s%s%s%s", error->message,
                     status == CONNECTION_REFUSED ? " [" : "",
                     status == CONNECTION_REFUSED ? error->name : "",
                     status == CONNECTION_REFUSED ? "]" : "");
    }
    return service_exit_code(status, error);
}

int service_open(service *s) {
    sheard_rpc_error error = {0};
    return service_say(connection_open(&s->connection, s->socket, s->reply_timeout_s, &error),
                       &error);
}

void service_close(service *s) {
    connection_close(s->connection);
    s->connection = NULL;
}

int service_call(service *s, int method, const sheard_params *params, sheard_reply *reply) {
    sheard_rpc_error error = {0};
    const int status =
        connection_call(s->connection, method, params, s->reply_timeout_s, reply, NULL, &error);
    return service_say(status, &error);
}

int service_answer(service *s, int method, const sheard_params *params, sheard_reply *reply) {
    if (!s->json) {
        return service_call(s, method, params, reply);
    }
    sheard_rpc_error error = {0};
    char *text = NULL;
    const int status =
        connection_call(s->connection, method, params, s->reply_timeout_s, reply, &text, &error);
    if (status == CONNECTION_OK) {
        puts(text);
        fflush(stdout);
    }
    free(text);
    return service_say(status, &error);
}

void service_count(service_tally *tally, int code) {
    tally->n++;
    tally->last_code = code;
    if (code != SHEAR_OK && tally->n_failed++ == 0) {
        tally->first_code = code;
    }
}

bool service_goes_on(const service_tally *tally) {
    return tally->last_code != EXIT_CODE_UNREACHABLE;
}

int service_tally_code(const service_tally *tally) {
    return tally->n_failed == 0         ? EXIT_CODE_DONE
           : !service_goes_on(tally)    ? EXIT_CODE_UNREACHABLE
           : tally->n_failed < tally->n ? EXIT_CODE_PARTLY
                                        : tally->first_code;
}

int service_job_id(const char *text, int64_t *id) {
    char *end = NULL;
    errno = 0;
    const long long value = strtoll(text, &end, 10);
    if (text[0] < '0' || text[0] > '9' || *end || errno || value < 1) {
        message_fail("\"shearctl jobs\" lists the jobs and their numbers",
                     "%s is not the number of a job", text);
        return EXIT_CODE_USAGE;
    }
    *id = value;
    return EXIT_CODE_DONE;
}
