/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl show: print all details of jobs. */
#include "remote/job_text.h"
#include "remote/service_query.h"

static void print(const sheard_reply *reply, const service *s) {
    job_text_print(&reply->job, s->utc, stdout);
}

static enum exit_code run(const command *self, int argc, char **argv) {
    return service_query_jobs(self, argc, argv, "job", SHEARD_METHOD_JOB, print);
}

const command cmd_show = {
    .name = "show",
    .summary = "everything about a job",
    .run = run,
    /* clang-format off */
    .usage =
    "usage: shearctl show [OPTION...] ID...\n"
    "\n"
    "Show a job: its state, source, result, settings, and what happened to it.\n"
    "\n"
    SERVICE_OPTIONS_HELP "\n"
    SERVICE_EXIT_CODES_HELP ".\n",
    /* clang-format on */
};
