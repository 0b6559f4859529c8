/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl doctor: check the installation of the service. */
#include "doctor/doctor.h"

#include "base/cleanup.h"
#include "commands/commands.h"

static enum exit_code run(const command *self, int argc, char **argv) {
    CLEANUP(doctor_deinit) doctor d = {.config = NULL};
    const option_entry options[] = {
        {.name = "config", .text = &d.config}, SERVICE_OPTIONS(&d.service), {0}};
    TRY(service_parse(self, argc, argv, options, &d.service, "", 0, 0));
    doctor_run(&d);
    return d.worst == SHEARD_CHECK_FAIL ? EXIT_CODE_OTHER : EXIT_CODE_DONE;
}

COMMAND(doctor, "is the set-up of the service sound?", run, NULL);
