/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl drain. */
#include "remote/service_query.h"

#include <inttypes.h>

static void print(const sheard_reply *reply) {
    printf("%s: %" PRId64 " jobs running, %" PRId64 " wait for the next start\n",
           sheard_server_state_name(reply->drain.state), reply->drain.running, reply->drain.queued);
}

static int run(int argc, char **argv) {
    return service_query(&cmd_drain, SHEARD_METHOD_DRAIN, print, argc, argv);
}

const command cmd_drain = {
    .name = "drain",
    .summary = "finish what runs, take nothing new",
    .usage = "usage: shearctl drain [OPTION...]\n"
             "\n"
             "Have the service finish the running jobs and take no new ones: submitting is "
             "refused, and files stay in\n"
             "incoming. Administrators only. It goes on working after a restart.\n"
             "\n" SERVICE_OPTIONS_HELP "\n" EXIT_CODES_SERVICE ".\n",
    .run = run,
};
