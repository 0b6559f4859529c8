/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl retry: see job_action.h. */
#include "remote/job_action.h"

static int run(int argc, char **argv) {
    return job_action_run(&cmd_retry, SHEARD_METHOD_RETRY, argc, argv);
}

const command cmd_retry = {
    .name = "retry",
    .summary = "run failed or cancelled jobs again",
    .usage = "usage: shearctl retry [OPTION...] ID...\n"
             "\n"
             "Queue jobs again that failed or were cancelled. Only the owner of a job and "
             "administrators may.\n"
             "\n" SERVICE_OPTIONS_HELP "\n" EXIT_CODES_SERVICE ".\n",
    .run = run,
};
