/* SPDX-License-Identifier: GPL-3.0-or-later */
/* command.h: what a subcommand of shearctl is. Each cmd_NAME.c exports one; main.c holds the table.
 */
#ifndef CLIENT_CMDLINE_COMMAND_H
#define CLIENT_CMDLINE_COMMAND_H

#include <stdio.h>

/* Exit codes, as in shearctl(1). */
enum {
    EXIT_CODE_DONE = 0,
    EXIT_CODE_OTHER = 1, /* anything that is not below: no memory, unwritable output, interrupted */
    EXIT_CODE_USAGE = 2, /* wrong options or settings */
    EXIT_CODE_INPUT = 3, /* bad input, all of it; no such file, job or field */
    EXIT_CODE_PARTLY = 4,     /* of several files, jobs or names some failed, the others are done */
    EXIT_CODE_JOB_FAILED = 5, /* every job that ended otherwise than done failed, none is done */
    EXIT_CODE_TIMED_OUT = 6,  /* --timeout is over and jobs are unfinished */
    EXIT_CODE_UNREACHABLE = 7, /* no service, it does not answer, or it is another release's */
    EXIT_CODE_CANCELLED = 8    /* the jobs were cancelled */
};
/* For the help of subcommands that talk to the service. */
#define EXIT_CODES_SERVICE                                                                         \
    "exit status: 0 done, 2 usage, 3 no such file, job or field, 4 some of several failed,\n"      \
    "7 the service cannot be reached, 1 anything else"

typedef struct command {
    const char *name;
    const char *summary; /* one line, no full stop */
    /* The whole help text. It begins with "usage: shearctl NAME ...". A line that is
     * COMMAND_SETTINGS_MARK alone stands for the options of all settings (settings_options.h). */
    const char *usage;
    /* argv[0] is the subcommand's name; returns an exit code. --help and -h are handled by main.c.
     */
    int (*run)(int argc, char **argv);
} command;

#define COMMAND_SETTINGS_MARK "structETTINGS@"

extern const command cmd_measure;
extern const command cmd_mock;
extern const command cmd_validate;
extern const command cmd_plot;
extern const command cmd_submit;
extern const command cmd_jobs;
extern const command cmd_show;
extern const command cmd_wait;
extern const command cmd_cancel;
extern const command cmd_retry;
extern const command cmd_retract;
extern const command cmd_forget;
extern const command cmd_field;
extern const command cmd_fields;
extern const command cmd_watch;
extern const command cmd_status;
extern const command cmd_metrics;
extern const command cmd_drain;
extern const command cmd_reload;
extern const command cmd_shutdown;
extern const command cmd_doctor;
extern const command cmd_help;
extern const command cmd_version;

/* The table, ended by NULL, in the order of the help text. */
const command *const *command_table(void);
/* The entry called `name`, or NULL; then an error with the nearest name has been printed. */
const command *command_find(const char *name);
/* Print the help text of one subcommand; `settings` prints the options of the settings
 * (settings_options_help). */
void command_print_usage(const command *self, void (*settings)(FILE *out), FILE *out);
/* Print the short list of all subcommands. */
void command_print_list(FILE *out);

#endif
