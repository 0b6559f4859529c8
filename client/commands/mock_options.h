/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mock_options.h: the command line of subcommands that draw mocks, by a table of shear_mocks. */
#pragma once

#include "cmdline/options.h"
#include "shear_mocks/mock.h"

/* What all of them have: the output file, and how it is written. */
typedef struct mock_options {
    int64_t threads;
    bool force, quiet;
    const char *path;
} mock_options;

/* Parse the options of table[n], each by `set` with the context `spec`, and those of *o. Returns an
 * exit code; on failure an error has been printed. */
enum exit_code mock_options_parse(const command *self, int argc, char **argv,
                                  const shear_mock_option *table, size_t n,
                                  enum exit_code (*set)(const option_entry *, const char *),
                                  void *spec, mock_options *o);
/* Print the error, if `code` is one. Return the exit code. */
enum exit_code mock_options_exit_code(int code, const shear_error *err);
