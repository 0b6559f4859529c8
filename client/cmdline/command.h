/* SPDX-License-Identifier: GPL-3.0-or-later */
/* command.h: the definition of a subcommand of shearctl, and the table of all subcommands. They are
 * defined in commands/, each with its help in NAME.txt; CMakeLists.txt lists them. */
#pragma once

#include "terminal/exit_code.h"

#include <stdio.h>

typedef struct command command;
struct command {
    const char *name;
    const char *summary; /* one line, no full stop */
    /* The whole help text. It begins with "usage: shearctl NAME ...". A line that is
     * COMMAND_SETTINGS_MARK alone stands for the options of all settings (settings_options.h). */
    const char *usage;
    /* argv[0] is the subcommand's name. --help and -h are handled by main.c. */
    enum exit_code (*run)(const command *self, int argc, char **argv);
    const void *data; /* for `run`, or NULL */
};

#define COMMAND_SETTINGS_MARK "@SETTINGS@"

/* Set the table: all subcommands in the order of the help text, ended by NULL, owned by the caller.
 * main.c does this first, because help and completion read the table. */
void command_set_table(const command *const *table);
const command *const *command_table(void);
/* Return the entry called `name`. If there is none, print an error with the nearest name and return
 * NULL. */
const command *command_find(const char *name);

/* Print the help text of one subcommand; `settings` prints the options of the settings
 * (settings_options_help). */
void command_print_usage(const command *self, void (*settings)(FILE *out), FILE *out);
/* Print the short list of all subcommands. */
void command_print_list(FILE *out);
