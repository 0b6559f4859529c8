/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl cancel: cancel jobs. */
#include "remote/service_query.h"

static void print(const sheard_reply *reply, const service *s) {
    (void)s;
    service_query_print_job(&reply->cancel);
}

static enum exit_code run(const command *self, int argc, char **argv) {
    return service_query_jobs(self, argc, argv, "jobs", SHEARD_METHOD_CANCEL, print);
}

const command cmd_cancel = {
    .name = "cancel",
    .summary = "cancel jobs",
    .run = run,
    /* clang-format off */
    .usage =
    "usage: shearctl cancel [OPTION...] ID...\n"
    "\n"
    "Cancel jobs that are not finished. A running one stops at its next block. Only the owner of a job and\n"
    "administrators may.\n"
    "\n"
    SERVICE_OPTIONS_HELP "\n"
    SERVICE_EXIT_CODES_HELP ".\n",
    /* clang-format on */
};
