/* SPDX-License-Identifier: GPL-3.0-or-later */
/* completion.h: the subcommands and their options as data for shell completion, extracted from the
 * help texts. */
#pragma once

#include "cmdline/command.h"

#include <stdio.h>

/* clang-format off */
/* Print lines whose fields are separated by '|' (no field contains one):
 *     command|NAME|OPERANDS|SUMMARY                OPERANDS: as in the usage, with ',' for '|'
 *     option|NAME|--OPTION|METAVAR|CHOICES|HELP    CHOICES: separated by spaces
 * Returns an exit code. */
/* clang-format on */
enum exit_code completion_data_print(FILE *out);

/* Print the `option` lines of one subcommand, found in its help text. */
void completion_options(const char *name, const char *usage, FILE *out);
