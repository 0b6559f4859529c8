/* SPDX-License-Identifier: GPL-3.0-or-later */
/* options.h: the parser of a subcommand's options, by a table with the destination of each value.
 */
#pragma once

#include "cmdline/command.h"
#include "shear/settings.h"

#include <stdbool.h>
#include <stdint.h>

/* One long option. Exactly one of flag, text, integer, seconds and set is given: the destination of
 * its value. */
typedef struct option_entry option_entry;
struct option_entry {
    const char *name; /* without "--" */
    char letter;      /* short form, or 0 */
    bool *flag;       /* set to true; the option has no value */
    const char **text;
    int64_t *integer; /* allowed values: min to max */
    int64_t min, max;
    double *seconds; /* "90", "500ms", "5min", "2h" */
    /* Handle any other kind of value; `value` is NULL if the option is bare. Returns an exit code;
     * on failure an error has been printed. */
    enum exit_code (*set)(const option_entry *entry, const char *value);
    void *context; /* for `set` */
    bool bare;     /* `set` gets no value */
    bool *given;   /* also set to true; may be NULL */
};

enum { SETTINGS_OPTIONS_MAX = 64 }; /* upper limit of the number of options of all settings */

/* The settings of the measurement, as options of a subcommand; the defaults unless given. */
typedef struct option_settings {
    shear_settings values;
    bool given[SETTINGS_OPTIONS_MAX]; /* by the index in shear_settings_table() */
} option_settings;

/* Parse the command line; the operands are argv[optind] and the following. `entries` ends with an
 * entry whose name is NULL. `settings`, initially {0}, is NULL if the subcommand has no settings.
 * Returns an exit code; on failure an error has been printed. */
enum exit_code options_parse(const command *self, int argc, char **argv,
                             const option_entry *entries, option_settings *settings);
/* Check the combination of all settings. Returns an exit code; on failure an error has been
 * printed. */
enum exit_code options_check_settings(const option_settings *settings);

/* Check that there are `min` to `max` operands; `what` names them in the error. Returns an exit
 * code; on failure an error has been printed. */
enum exit_code options_count_operands(const command *self, int argc, char **argv, const char *what,
                                      int min, int max);

/* Parse a decimal integer from min to max. Returns an exit code; on failure an error that names the
 * option has been printed. */
enum exit_code options_integer(const char *option, const char *text, int64_t min, int64_t max,
                               int64_t *out);

/* Print an error in the use of the subcommand, with a reference to its help. Returns
 * EXIT_CODE_USAGE. */
enum exit_code options_fail(const command *self, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
