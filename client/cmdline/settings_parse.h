/* SPDX-License-Identifier: GPL-3.0-or-later */
/* settings_parse.h: the command line of a subcommand that measures: options of its own, and those
 * of all settings. */
#ifndef CLIENT_CMDLINE_SETTINGS_PARSE_H
#define CLIENT_CMDLINE_SETTINGS_PARSE_H

#include "cmdline/command.h"
#include "shear/settings.h"

#include <getopt.h>

typedef struct settings_parser {
    const command *self;
    const struct option *own; /* [n_own], at most 64; without the zeros at the end */
    size_t n_own;
    const char *letters; /* short options as for getopt_long, without the ':' before; may be NULL */
    /* One of its own options; 0, or an exit code with an error printed. */
    int (*handle)(int value, const char *argument, void *context);
    void *context;
    shear_settings *settings; /* set and, at the end, checked */
    bool given;               /* out: was one of the settings given? */
} settings_parser;

/* Parse up to optind. 0, or an exit code with an error printed. */
int settings_parse(settings_parser *p, int argc, char **argv);

#endif
