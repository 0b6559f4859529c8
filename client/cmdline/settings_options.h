/* SPDX-License-Identifier: GPL-3.0-or-later */
/* settings_options.h: the settings of the measurement as long options, generated from
 * shear_settings_table().
 *
 * Every setting is --NAME VALUE; a boolean one is --NAME and --no-NAME. options_parse adds these
 * options to those of a subcommand. */
#pragma once

#include "cmdline/options.h"

#include <stdio.h>

/* Set *settings to the defaults, and add an entry for each option of the settings, which sets it;
 * the result does not depend on the order of the options. `entries` has room for
 * SETTINGS_OPTIONS_MAX. Returns their number. */
size_t settings_options_add(option_entry *entries, option_settings *settings);

/* Print the help lines of all settings: option, default, help. */
void settings_options_help(FILE *out);
/* Print the same as an mdoc(7) list, for the manual page. */
void settings_options_man(FILE *out);
