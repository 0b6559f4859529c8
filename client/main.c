/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl: the table of subcommands and the choice of one. */
#include "cmdline/command.h"
#include "cmdline/settings_options.h"
#include "terminal/message.h"

#include <errno.h>
#include <locale.h>
#include <stdbool.h>
#include <string.h>

static const command *const table[] = {
    &cmd_measure, &cmd_mock,   &cmd_validate, &cmd_plot,   &cmd_submit,  &cmd_jobs,
    &cmd_show,    &cmd_wait,   &cmd_cancel,   &cmd_retry,  &cmd_retract, &cmd_field,
    &cmd_fields,  &cmd_forget, &cmd_watch,    &cmd_status, &cmd_metrics, &cmd_doctor,
    &cmd_drain,   &cmd_reload, &cmd_shutdown, &cmd_help,   &cmd_version, NULL,
};

const command *const *command_table(void) {
    return table;
}

static bool asks_for_help(int argc, char **argv) {
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            return true;
        }
    }
    return false;
}

static int run(int argc, char **argv) {
    const char *name = argc > 1 ? argv[1] : "--help";
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
        command_print_list(stdout);
        return EXIT_CODE_DONE;
    }
    if (strcmp(name, "--version") == 0) {
        name = cmd_version.name;
    }
    const command *self = command_find(name);
    if (self == NULL) {
        return EXIT_CODE_USAGE;
    }
    if (asks_for_help(argc - 1, argv + 1)) {
        command_print_usage(self, settings_options_help, stdout);
        return EXIT_CODE_DONE;
    }
    return self->run(argc - 1, argv + 1);
}

int main(int argc, char **argv) {
    /* The text's language and the terminal's characters, but never a decimal comma: files and
     * scripts read this. */
    setlocale(LC_CTYPE, "");
    int code = run(argc, argv);
    if (fflush(stdout) != 0 || ferror(stdout) != 0) {
        message_fail(NULL, "cannot write to standard output: %s", strerror(errno));
        return code == EXIT_CODE_DONE ? EXIT_CODE_OTHER : code;
    }
    return code;
}
