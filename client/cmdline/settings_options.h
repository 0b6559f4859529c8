/* SPDX-License-Identifier: GPL-3.0-or-later */
/* settings_options.h: the settings of the measurement as long options, made from
 * shear_settings_table().
 *
 * Every setting is --NAME VALUE; a boolean one is --NAME and --no-NAME. options.h uses these for
 * every subcommand. */
#ifndef CLIENT_CMDLINE_SETTINGS_OPTIONS_H
#define CLIENT_CMDLINE_SETTINGS_OPTIONS_H

#include "shear/settings.h"

#include <getopt.h>
#include <stdio.h>

enum {
    SETTINGS_OPTIONS_MAX = 64,   /* more than the options of all settings */
    SETTINGS_OPTION_FIRST = 4096 /* their values for getopt_long begin here: keep yours below */
};

/* Write one entry per option and the all-zero entry that ends the array. `capacity` is the number
 * of entries that fit: SETTINGS_OPTIONS_MAX + 1 is always enough. Returns the number written,
 * without the last. */
size_t settings_options_fill(struct option *options, size_t capacity);

/* True where `value`, as returned by getopt_long, belongs to a setting. */
bool settings_options_is(int value);

/* Put the option's argument (NULL for booleans) into *s; the order of options does not count.
 * `given` [SETTINGS_OPTIONS_MAX], false at first: which entries of shear_settings_table() have been
 * given. SHEAR_OK or SHEAR_E_SETTING. */
int settings_options_handle(int value, const char *argument, shear_settings *s, bool *given,
                            shear_error *err);

/* The help lines of all settings: option, default, help. */
void settings_options_help(FILE *out);
/* The same as an mdoc(7) list, for the manual page. */
void settings_options_man(FILE *out);

#endif
