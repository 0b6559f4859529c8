/* SPDX-License-Identifier: GPL-3.0-or-later */
/* options.h: the command line of a subcommand, parsed by a table that says where each value goes.
 */
#ifndef CLIENT_CMDLINE_OPTIONS_H
#define CLIENT_CMDLINE_OPTIONS_H

#include "cmdline/command.h"
#include "cmdline/settings_options.h"

#include <stdbool.h>
#include <stdint.h>

/* One long option. Exactly one of flag, text, integer, seconds and set says where its value goes.
 */
typedef struct option_entry option_entry;
struct option_entry {
    const char *name; /* without "--" */
    char letter;      /* of its short form, or 0 */
    bool *flag;       /* becomes true: the option has no value */
    const char **text;
    int64_t *integer; /* from min to max */
    int64_t min, max;
    double *seconds; /* "90", "500ms", "5min", "2h" */
    /* Any other value; NULL if the option is bare. Returns an exit code, with an error printed. */
    enum exit_code (*set)(const option_entry *entry, const char *value);
    void *context; /* of `set` */
    bool bare;     /* `set` takes no value */
    bool *given;   /* becomes true besides, or NULL */
};

/* The settings of the measurement, as options of a subcommand. Begin with OPTION_SETTINGS_INIT. */
typedef struct option_settings {
    shear_settings values;
    bool given[SETTINGS_OPTIONS_MAX]; /* by the index in shear_settings_table() */
} option_settings;

/* Parse; operands are argv[optind] and on. `entries` ends with a NULL name. `settings` may be NULL:
 * the subcommand has none. Returns an exit code, with an error printed. */
enum exit_code options_parse(const command *self, int argc, char **argv,
                             const option_entry *entries, option_settings *settings);
/* Are the settings good all together? Returns an exit code, with an error printed. */
enum exit_code options_check_settings(const option_settings *settings);

/* Is the number of operands from `min` to `max` of what `what` names? Returns an exit code, with an
 * error printed. */
enum exit_code options_count_operands(const command *self, int argc, char **argv, const char *what,
                                      int min, int max);

/* A decimal integer from min to max. Returns an exit code, with an error printed that names the
 * option. */
enum exit_code options_integer(const char *option, const char *text, int64_t min, int64_t max,
                               int64_t *out);

/* An error in how the subcommand was called, with a reference to its help. Returns EXIT_CODE_USAGE.
 */
enum exit_code options_fail(const command *self, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
