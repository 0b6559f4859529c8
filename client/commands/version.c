/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl version: print the version, and the compiler and libraries that were used. */
#include "shear/version.h"
#include "build_info.h"
#include "commands/commands.h"
#include "terminal/message.h"

static enum exit_code run(const command *self, int argc, char **argv) {
    (void)argv;
    if (argc > 1)
        return message_fail(EXIT_CODE_USAGE, NULL, "%s: expected no arguments", self->name);
    printf("shearctl %s\nlibshear    %s\n%s", SHEAR_VERSION_STRING, shear_version(), BUILD_INFO);
    return EXIT_CODE_DONE;
}

COMMAND(version, "print the version, and the libraries that it was built with", run, NULL);
