/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl retract: remove jobs' contributions from their fields. */
#include "remote/service_query.h"

static void print(const sheard_reply *reply, const service *s) {
    (void)s;
    service_query_print_job(&reply->retract);
}

static enum exit_code run(const command *self, int argc, char **argv) {
    return service_query_jobs(self, argc, argv, "jobs", SHEARD_METHOD_RETRACT, print);
}

const command cmd_retract = {
    .name = "retract",
    .summary = "take back what jobs counted",
    .run = run,
    /* clang-format off */
    .usage =
    "usage: shearctl retract [OPTION...] ID...\n"
    "\n"
    "Take the contributions of counted jobs out of their fields again: the results are, to the last bit,\n"
    "as if they had never been. The same files may be submitted again; dropped ones stay in done/. Only\n"
    "the owner of a job and administrators may.\n"
    "\n"
    SERVICE_OPTIONS_HELP "\n"
    SERVICE_EXIT_CODES_HELP ".\n",
    /* clang-format on */
};
