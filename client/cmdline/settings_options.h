/* SPDX-License-Identifier: GPL-3.0-or-later */
/* settings_options.h: the settings of the measurement as long options, generated from
 * shear_settings_table().
 *
 * Every setting is --NAME VALUE; a boolean one is --NAME and --no-NAME. options.h adds these
 * options to those of a subcommand. */
#pragma once

#include "shear/settings.h"

#include <getopt.h>
#include <stdio.h>

enum {
    SETTINGS_OPTIONS_MAX = 64, /* upper limit of the number of options of all settings */
    SETTINGS_OPTION_FIRST =
        4096 /* first of their values for getopt_long: other options stay below */
};

/* Write one entry per option, then the all-zero entry that ends the array. `capacity` is the number
 * of entries that fit: SETTINGS_OPTIONS_MAX + 1 is always enough. Returns the number of options. */
size_t settings_options_fill(struct option *options, size_t capacity);

/* Return whether `value`, returned by getopt_long, belongs to a setting. */
bool settings_options_is(int value);

/* Store the option's argument (NULL for booleans) in *s; the result does not depend on the order of
 * the options. Mark the setting in `given` [SETTINGS_OPTIONS_MAX], indexed like
 * shear_settings_table() and initially false. Returns SHEAR_OK or SHEAR_E_SETTING. */
int settings_options_handle(int value, const char *argument, shear_settings *s, bool *given,
                            shear_error *err);

/* Print the help lines of all settings: option, default, help. */
void settings_options_help(FILE *out);
/* Print the same as an mdoc(7) list, for the manual page. */
void settings_options_man(FILE *out);
