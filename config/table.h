/* SPDX-License-Identifier: GPL-3.0-or-later */
/* table.h: the daemon's own rows of the table of settings, and its sections. */
#pragma once

#include "sheard/config.h"

/* Longest texts in bytes. A line has INI_LINE_MAX, and a path that is printed must be loaded again.
 */
enum { CONFIG_PATH_MAX = 180, CONFIG_SOCKET_MAX = 107, CONFIG_NAME_MAX = 32 };

/* The daemon's own rows, the first settings of the table. shear_settings_table has the others. */
extern const sheard_setting config_rows[];
extern const size_t config_n_rows;

/* Return the member of a row in a config. Not for SHEARD_T_MEASURE. */
void *config_member(sheard_config *config, const sheard_setting *s);
const void *config_const_member(const sheard_config *config, const sheard_setting *s);

/* Return the section, or the section's key, nearest to a misspelt one, or NULL if none is near. */
const char *config_nearest_section(const char *name);
const char *config_nearest_key(const char *section, const char *key);

/* Return another section that has this key, or NULL. */
const char *config_section_of(const char *key);
