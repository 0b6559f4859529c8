/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl drain: let the service finish the running jobs, and accept no new ones. */
#include "remote/service_query.h"
#include "remote/status_text.h"

static void print(const sheard_reply *reply, const service *s) {
    (void)s;
    status_text_stopping(&reply->drain, stdout);
}

static enum exit_code run(const command *self, int argc, char **argv) {
    return service_query(self, argc, argv, SHEARD_METHOD_DRAIN, print);
}

const command cmd_drain = {
    .name = "drain",
    .summary = "finish what runs, take nothing new",
    .run = run,
    /* clang-format off */
    .usage =
    "usage: shearctl drain [OPTION...]\n"
    "\n"
    "Have the service finish the running jobs and take no new ones: submitting is refused, and files stay in\n"
    "incoming. Administrators only. After a restart it takes jobs again.\n"
    "\n"
    SERVICE_OPTIONS_HELP "\n"
    SERVICE_EXIT_CODES_HELP ".\n",
    /* clang-format on */
};
