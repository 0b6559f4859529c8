/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl help [SUBCOMMAND]; the hidden --settings-man feeds the manual page (man/CMakeLists.txt).
 */
#include "command.h"
#include "message.h"
#include "settings_options.h"

#include <string.h>

static int run(int argc, char **argv) {
    if (argc > 2) {
        message_fail("\"shearctl help SUBCOMMAND\"", "help: expected one name, got %d", argc - 1);
        return EXIT_CODE_USAGE;
    }
    if (argc < 2) {
        command_print_list(stdout);
        return EXIT_CODE_DONE;
    }
    if (strcmp(argv[1], "--settings-man") == 0) {
        settings_options_man(stdout);
        return EXIT_CODE_DONE;
    }
    const struct command *command = command_find(argv[1]);
    if (!command) {
        return EXIT_CODE_USAGE;
    }
    command_print_usage(command, stdout);
    return EXIT_CODE_DONE;
}

const struct command cmd_help = {
    .name = "help",
    .summary = "explain a subcommand",
    .usage = "usage: shearctl help [SUBCOMMAND]\n"
             "\n"
             "Explain a subcommand and its options, or list all subcommands.\n",
    .run = run,
};
