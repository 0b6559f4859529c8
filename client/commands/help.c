/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl help [SUBCOMMAND]. Three hidden options: --settings-man and --man SUBCOMMAND (the help
 * text with a reference to SETTINGS) generate the manual page (man/paste.cmake); --completion-data
 * generates the shells' completions. */
#include "cmdline/completion.h"
#include "cmdline/settings_options.h"
#include "commands/commands.h"
#include "terminal/message.h"

#include <string.h>

static void refer_to_settings(FILE *out) {
    fputs("  all options of SETTINGS\n", out);
}

static enum exit_code explain(const char *name, void (*settings)(FILE *out)) {
    const command *found = command_find(name);
    if (found == NULL)
        return EXIT_CODE_USAGE;
    command_print_usage(found, settings, stdout);
    return EXIT_CODE_DONE;
}

static enum exit_code run(const command *self, int argc, char **argv) {
    if (argc < 2) {
        command_print_list(stdout);
        return EXIT_CODE_DONE;
    }
    if (argc == 2 && strcmp(argv[1], "--settings-man") == 0) {
        settings_options_man(stdout);
        return EXIT_CODE_DONE;
    }
    if (argc == 2 && strcmp(argv[1], "--completion-data") == 0)
        return completion_data_print(stdout);
    if (argc == 3 && strcmp(argv[1], "--man") == 0)
        return explain(argv[2], refer_to_settings);
    if (argc > 2) {
        return message_fail(EXIT_CODE_USAGE, "\"shearctl help SUBCOMMAND\"",
                            "%s: expected one name, got %d", self->name, argc - 1);
    }
    return explain(argv[1], settings_options_help);
}

COMMAND(help, "explain a subcommand", run, NULL);
