/* SPDX-License-Identifier: GPL-3.0-or-later */
/* options.h: what every subcommand needs beside getopt_long (call it with opterr = 0 and a
 * short-option string that begins with ':'). */
#ifndef CLIENT_CMDLINE_OPTIONS_H
#define CLIENT_CMDLINE_OPTIONS_H

#include "cmdline/command.h"

#include <getopt.h>
#include <stdint.h>

/* getopt_long returned '?' or ':' (in `value`): say what is wrong with the option, with the nearest
 * name of `options`. Returns EXIT_CODE_USAGE. */
int options_bad(const command *self, int value, char **argv, const struct option *options);

/* Parse a decimal integer of the range [min, max]. Returns 0; or EXIT_CODE_USAGE, with an error
 * printed that names `option`. */
int options_int(const char *option, const char *text, int64_t min, int64_t max, int64_t *out);

/* The entry of `names` (ended by NULL) that is nearest to `name`, or NULL where none is near. */
const char *options_nearest(const char *name, const char *const *names);

#endif
