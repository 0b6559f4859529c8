/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl shutdown: stop the service. */
#include "base/cleanup.h"
#include "commands/commands.h"
#include "remote/service_query.h"
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

static void print(const sheard_reply *reply, const service *s) {
    (void)s;
    status_text_stopping(&reply->shutdown, stdout);
}

static enum exit_code run(const command *self, int argc, char **argv) {
    CLEANUP(service_close) service s = {0};
    sheard_params p;
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
    TRY(service_ask(&s, SHEARD_METHOD_SHUTDOWN, &p, print));
    if (comes_back) {
        puts("systemd keeps the socket: the next client, or dropped file, starts the service "
             "again; \"systemctl stop sheard.service\" stops both");
    }
    return EXIT_CODE_DONE;
}

COMMAND(shutdown, "stop the service", run, NULL);
