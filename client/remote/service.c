/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/service.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "terminal/human.h"
#include "terminal/message.h"

static const double default_reply_timeout_s = 30.0;

enum exit_code service_set_reply_timeout(const option_entry *entry, const char *value) {
    service *s = entry->context;
    if (!human_parse_duration(value, &s->reply_timeout_s) || s->reply_timeout_s <= 0.0) {
        return message_fail(EXIT_CODE_USAGE, NULL,
                            "--reply-timeout %s: expected a time, as 30, 500ms, 2min", value);
    }
    return EXIT_CODE_DONE;
}

void service_init(service *s) {
    *s = (service){.socket = connection_default_path(), .reply_timeout_s = default_reply_timeout_s};
}

enum exit_code service_parse(const command *self, int argc, char **argv,
                             const option_entry *entries, service *s, const char *what, int min,
                             int max) {
    service_init(s);
    TRY(options_parse(self, argc, argv, entries, NULL));
    return options_count_operands(self, argc, argv, what, min, max);
}

enum exit_code service_start(const command *self, int argc, char **argv,
                             const option_entry *entries, service *s, const char *what, int min,
                             int max) {
    TRY(service_parse(self, argc, argv, entries, s, what, min, max));
    return service_open(s);
}

/* Return the exit code for an error with which the service replied. */
static enum exit_code code_of_refusal(int code) {
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

static enum exit_code exit_code_of(enum connection_status status, const sheard_rpc_error *error) {
    switch (status) {
    case CONNECTION_OK:
        return EXIT_CODE_DONE;
    case CONNECTION_REFUSED:
        return code_of_refusal(error->code);
    case CONNECTION_UNREACHABLE:
    case CONNECTION_DENIED:
    case CONNECTION_MISMATCH:
    case CONNECTION_SILENT:
        return EXIT_CODE_UNREACHABLE;
    default:
        return EXIT_CODE_OTHER;
    }
}

enum exit_code service_say(enum connection_status status, const sheard_rpc_error *error) {
    const enum exit_code code = exit_code_of(status, error);
    if (status == CONNECTION_OK)
        return code;
    return status == CONNECTION_REFUSED
               ? message_fail(code, error->advice, "%s [%s]", error->message, error->name)
               : message_fail(code, error->advice, "%s", error->message);
}

enum exit_code service_open(service *s) {
    sheard_rpc_error error = {0};
    return service_say(connection_open(&s->connection, s->socket, s->reply_timeout_s, &error),
                       &error);
}

void service_close(service *s) {
    connection_close(s->connection);
    s->connection = NULL;
}

enum exit_code service_call(service *s, int method, const sheard_params *params,
                            sheard_reply *reply, char **text) {
    sheard_rpc_error error = {0};
    const enum connection_status status =
        connection_call(s->connection, method, params, s->reply_timeout_s, reply, text, &error);
    return service_say(status, &error);
}

enum exit_code service_answer(service *s, int method, const sheard_params *params,
                              sheard_reply *reply) {
    CLEANUP(release_free) char *text = NULL;
    TRY(service_call(s, method, params, reply, s->json ? &text : NULL));
    if (s->json) {
        puts(text);
        fflush(stdout);
    }
    return EXIT_CODE_DONE;
}

enum exit_code service_job_id(const char *text, int64_t *id) {
    if (text[0] < '0' || text[0] > '9' || !text_to_int64(text, id) || *id < 1) {
        return message_fail(EXIT_CODE_USAGE, "\"shearctl jobs\" lists the jobs and their numbers",
                            "%s is not the number of a job", text);
    }
    return EXIT_CODE_DONE;
}
