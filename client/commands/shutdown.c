/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl shutdown: stop the service. */
#include "remote/service.h"
#include "terminal/human.h"
#include "terminal/message.h"

#include <inttypes.h>

enum { OPT_NOW = 256, OPT_TIMEOUT };

static const struct option options[] = {
    {"now", no_argument, NULL, OPT_NOW},
    {"timeout", required_argument, NULL, OPT_TIMEOUT},
    SERVICE_OPTIONS,
    {NULL, 0, NULL, 0},
};

static int handle(int value, void *context) {
    sheard_msg_shutdown *what = context;
    if (value == OPT_NOW) {
        what->mode = SHEARD_SHUTDOWN_NOW;
    } else if (!human_parse_duration(optarg, &what->timeout_s)) {
        message_fail(NULL, "--timeout %s: expected a time, as 90, 500ms, 5min, 2h", optarg);
        return EXIT_CODE_USAGE;
    }
    return EXIT_CODE_DONE;
}

/* Is the socket systemd's? A client that asks now and then would undo the stop. */
static bool is_activated(service *s) {
    sheard_rpc_error error;
    sheard_reply reply = {0};
    const bool known = connection_call(s->connection, SHEARD_METHOD_STATUS, NULL,
                                       s->reply_timeout_s, &reply, NULL, &error) == CONNECTION_OK;
    const bool activated = known && reply.status.activated;
    sheard_reply_deinit(&reply, SHEARD_METHOD_STATUS);
    return activated;
}

static int run(int argc, char **argv) {
    service s;
    sheard_params p;
    sheard_reply reply = {0};
    sheard_params_init(&p, SHEARD_METHOD_SHUTDOWN);
    int code = service_parse_operands(&cmd_shutdown, argc, argv, options, handle, &p.shutdown, &s,
                                      "", 0, 0);
    code = code != SHEAR_OK ? code : service_open(&s);
    if (code != SHEAR_OK) {
        return code;
    }
    const bool comes_back = !s.json && is_activated(&s);
    code = service_answer(&s, SHEARD_METHOD_SHUTDOWN, &p, &reply);
    if (code == SHEAR_OK && !s.json) {
        printf("%s: %" PRId64 " jobs running, %" PRId64 " wait for the next start\n",
               sheard_server_state_name(reply.shutdown.state), reply.shutdown.running,
               reply.shutdown.queued);
    }
    if (code == SHEAR_OK && comes_back) {
        puts(
            "systemd keeps the socket: the next client, or dropped file, starts the service again; "
            "\"systemctl stop sheard.service\" stops both");
    }
    sheard_reply_deinit(&reply, SHEARD_METHOD_SHUTDOWN);
    service_close(&s);
    return code;
}

const command cmd_shutdown = {
    .name = "shutdown",
    .summary = "stop the service",
    .usage = "usage: shearctl shutdown [OPTION...]\n"
             "\n"
             "Stop the service: it waits for the running jobs, as long as its configuration says. "
             "What is\n"
             "unfinished then goes on from its checkpoint at the next start. Administrators "
             "only.\n"
             "\n"
             "  --now                   do not wait\n"
             "  --timeout TIME          wait no longer than this (as 90, 500ms, "
             "5min)\n" SERVICE_OPTIONS_HELP "\n" EXIT_CODES_SERVICE ".\n",
    .run = run,
};
