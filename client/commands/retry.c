/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl retry: run failed or cancelled jobs again. */
#include "remote/service_query.h"

static void print(const sheard_reply *reply, const service *s) {
    (void)s;
    service_query_print_job(&reply->retry);
}

static enum exit_code run(const command *self, int argc, char **argv) {
    return service_query_jobs(self, argc, argv, "jobs", SHEARD_METHOD_RETRY, print);
}

const command cmd_retry = {
    .name = "retry",
    .summary = "run failed or cancelled jobs again",
    .run = run,
    /* clang-format off */
    .usage =
    "usage: shearctl retry [OPTION...] ID...\n"
    "\n"
    "Queue jobs again that failed or were cancelled. Only the owner of a job and administrators may.\n"
    "\n"
    SERVICE_OPTIONS_HELP "\n"
    SERVICE_EXIT_CODES_HELP ".\n",
    /* clang-format on */
};
