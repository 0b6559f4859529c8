/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl: main(), which chooses the subcommand. */
#include "cmdline/settings_options.h"
#include "commands/commands.h"
#include "terminal/message.h"

#include <errno.h>
#include <locale.h>
#include <stdbool.h>
#include <string.h>

#define ENTRY(name) &cmd_##name,
static const command *const table[] = {COMMAND_LIST(ENTRY) NULL};

static bool is_help(const char *argument) {
    return strcmp(argument, "--help") == 0 || strcmp(argument, "-h") == 0;
}

static bool asks_for_help(int argc, char **argv) {
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (is_help(argv[i]))
            return true;
    }
    return false;
}

static enum exit_code run(int argc, char **argv) {
    const char *name = argc > 1 ? argv[1] : "--help";
    if (is_help(name)) {
        command_print_list(stdout);
        return EXIT_CODE_DONE;
    }
    const command *chosen = strcmp(name, "--version") == 0 ? &cmd_version : command_find(name);
    if (chosen == NULL)
        return EXIT_CODE_USAGE;
    if (asks_for_help(argc - 1, argv + 1)) {
        command_print_usage(chosen, settings_options_help, stdout);
        return EXIT_CODE_DONE;
    }
    return chosen->run(chosen, argc - 1, argv + 1);
}

int main(int argc, char **argv) {
    /* Use the locale's messages and characters, but not its decimal comma: files and scripts need a
     * point. */
    setlocale(LC_CTYPE, "");
    command_set_table(table);
    const enum exit_code code = run(argc, argv);
    if (fflush(stdout) != 0 || ferror(stdout) != 0) {
        message_fail(EXIT_CODE_OTHER, NULL, "cannot write to standard output: %s", strerror(errno));
        return code == EXIT_CODE_DONE ? EXIT_CODE_OTHER : (int)code;
    }
    return (int)code;
}
