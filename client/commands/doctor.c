/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl doctor: check the installation of the service. */
#include "doctor/doctor.h"

#include "base/cleanup.h"

static enum exit_code run(const command *self, int argc, char **argv) {
    CLEANUP(doctor_deinit) doctor d = {.config = NULL};
    const option_entry options[] = {
        {.name = "config", .text = &d.config}, SERVICE_OPTIONS(&d.service), {0}};
    TRY(service_parse(self, argc, argv, options, &d.service, "", 0, 0));
    doctor_run(&d);
    return d.worst == SHEARD_CHECK_FAIL ? EXIT_CODE_OTHER : EXIT_CODE_DONE;
}

const command cmd_doctor = {
    .name = "doctor",
    .summary = "is the set-up of the service sound?",
    .run = run,
    /* clang-format off */
    .usage =
    "usage: shearctl doctor [OPTION...]\n"
    "\n"
    "Look at the program and configuration of the service, its socket and who may connect, release and\n"
    "protocol, disks, spool, clocks, data roots. A running service is asked for its paths and what it\n"
    "sees of them, and measures a tiny field of its own. If no service answers, doctor checks the paths\n"
    "as the user who runs it (root tries as the user sheard), and what the kernel offers.\n"
    "Each line is OK, WARN or FAIL, with the remedy. Nothing is changed.\n"
    "\n"
    "  --config FILE           the configuration (default: the installed one)\n"
    SERVICE_OPTIONS_HELP "\n"
    "exit status: 0 sound (maybe with warnings), 1 something failed, 2 usage.\n",
    /* clang-format on */
};
