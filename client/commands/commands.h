/* SPDX-License-Identifier: GPL-3.0-or-later */
/* commands.h: all subcommands. */
#ifndef CLIENT_COMMANDS_COMMANDS_H
#define CLIENT_COMMANDS_COMMANDS_H

#include "cmdline/command.h"
#include "command_list.h" /* COMMAND_LIST(X): made by CMake */

#define COMMANDS_DECLARE(name) extern const command cmd_##name;
COMMAND_LIST(COMMANDS_DECLARE)

#endif
