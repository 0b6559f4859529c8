/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl shutdown: stop the service. */
#include "base/cleanup.h"
#include "remote/service.h"
#include "remote/status_text.h"

/* Return whether systemd owns the socket: then any client's request would start the service again.
 */
static bool is_activated(service *s) {
    sheard_rpc_error error;
    sheard_reply reply = {0};
    const bool known = connection_call(s->connection, SHEARD_METHOD_STATUS, NULL,
                                       s->reply_timeout_s, &reply, NULL, &error) == CONNECTION_OK;
    const bool activated = known && reply.status.activated;
    sheard_reply_deinit(&reply, SHEARD_METHOD_STATUS);
    return activated;
}

static enum exit_code run(const command *self, int argc, char **argv) {
    CLEANUP(service_close) service s = {0};
    sheard_params p;
    sheard_reply reply = {0};
    bool now = false;
    sheard_params_init(&p, SHEARD_METHOD_SHUTDOWN);
    const option_entry options[] = {{.name = "now", .flag = &now},
                                    {.name = "timeout", .seconds = &p.shutdown.timeout_s},
                                    SERVICE_OPTIONS(&s),
                                    {0}};
    TRY(service_start(self, argc, argv, options, &s, "", 0, 0));
    if (now)
        p.shutdown.mode = SHEARD_SHUTDOWN_NOW;
    const bool comes_back = !s.json && is_activated(&s);
    const enum exit_code code = service_answer(&s, SHEARD_METHOD_SHUTDOWN, &p, &reply);
    if (code == EXIT_CODE_DONE && !s.json) {
        status_text_stopping(&reply.shutdown, stdout);
        if (comes_back) {
            puts("systemd keeps the socket: the next client, or dropped file, starts the service "
                 "again; \"systemctl stop sheard.service\" stops both");
        }
    }
    sheard_reply_deinit(&reply, SHEARD_METHOD_SHUTDOWN);
    return code;
}

const command cmd_shutdown = {
    .name = "shutdown",
    .summary = "stop the service",
    .run = run,
    /* clang-format off */
    .usage =
    "usage: shearctl shutdown [OPTION...]\n"
    "\n"
    "Stop the service: it waits for the running jobs, as long as its configuration says. What is\n"
    "unfinished then goes on from its checkpoint at the next start. Administrators only.\n"
    "\n"
    "  --now                   do not wait\n"
    "  --timeout TIME          wait no longer than this (as 90, 500ms, 5min)\n"
    SERVICE_OPTIONS_HELP "\n"
    SERVICE_EXIT_CODES_HELP ".\n",
    /* clang-format on */
};
