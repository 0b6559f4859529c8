/* SPDX-License-Identifier: GPL-3.0-or-later */
/* completion.h: the subcommands and their options as data for the shells' completions, taken from
 * the help texts so that nothing is written twice. */
#ifndef CLIENT_CMDLINE_COMPLETION_H
#define CLIENT_CMDLINE_COMPLETION_H

#include "cmdline/command.h"

#include <stdio.h>

/* Lines of fields with '|' between them, no field has one:
 *     command|NAME|OPERANDS|SUMMARY       OPERANDS: as in the usage, commas for '|'
 *     option|NAME|--OPTION|METAVAR|CHOICES|HELP    CHOICES: words with spaces between them
 * Returns an exit code. */
enum exit_code completion_data_print(FILE *out);

/* The options of one help text. */
void completion_options(const char *name, const char *usage, FILE *out);

#endif
