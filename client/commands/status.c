/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl status: print the state of the service. */
#include "remote/service_query.h"
#include "remote/status_text.h"
#include "terminal/style.h"

static void print(const sheard_reply *reply, const service *s) {
    status_text_brief(&reply->status, style_on(stdout), stdout);
    status_text_rest(&reply->status, s->utc, stdout);
}

static enum exit_code run(const command *self, int argc, char **argv) {
    return service_query(self, argc, argv, SHEARD_METHOD_STATUS, print);
}

const command cmd_status = {
    .name = "status",
    .summary = "the state of the service",
    .run = run,
    /* clang-format off */
    .usage =
    "usage: shearctl status [OPTION...]\n"
    "\n"
    "Print the state of the service: queue, workers, rates, disks, totals, and what an operator should\n"
    "look at.\n"
    "\n"
    SERVICE_OPTIONS_HELP "\n"
    SERVICE_EXIT_CODES_HELP ".\n",
    /* clang-format on */
};
