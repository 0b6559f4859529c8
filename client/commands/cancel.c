/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl cancel: see job_action.h. */
#include "remote/job_action.h"

static int run(int argc, char **argv) {
    return job_action_run(&cmd_cancel, SHEARD_METHOD_CANCEL, argc, argv);
}

const command cmd_cancel = {
    .name = "cancel",
    .summary = "cancel jobs",
    .usage = "usage: shearctl cancel [OPTION...] ID...\n"
             "\n"
             "Cancel jobs that are not finished. A running one stops at its next block. Only the "
             "owner of a job and\n"
             "administrators may.\n"
             "\n" SERVICE_OPTIONS_HELP "\n" EXIT_CODES_SERVICE ".\n",
    .run = run,
};
