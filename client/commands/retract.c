/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl retract: see job_action.h. */
#include "remote/job_action.h"

static int run(int argc, char **argv) {
    return job_action_run(&cmd_retract, SHEARD_METHOD_RETRACT, argc, argv);
}

const command cmd_retract = {
    .name = "retract",
    .summary = "take back what jobs counted",
    .usage =
        "usage: shearctl retract [OPTION...] ID...\n"
        "\n"
        "Take the contributions of counted jobs out of their fields again: the results are, to the "
        "last bit,\n"
        "as if they had never been. The same files may be submitted again; dropped ones stay in "
        "done/. Only\n"
        "the owner of a job and administrators may.\n"
        "\n" SERVICE_OPTIONS_HELP "\n" EXIT_CODES_SERVICE ".\n",
    .run = run,
};
