/* SPDX-License-Identifier: GPL-3.0-or-later */
/* table.h: the rows of the settings' table that are the daemon's own, and its sections. */
#ifndef CONFIG_TABLE_H
#define CONFIG_TABLE_H

#include "sheard/config.h"

/* Bytes of a path: inih's lines have 198, and what is printed must load again. */
enum { CONFIG_PATH_MAX = 180, CONFIG_SOCKET_MAX = 107, CONFIG_NAME_MAX = 32 };

/* The daemon's own rows: the first settings. shear_settings_table has the others. */
extern const sheard_setting config_rows[];
extern const size_t config_n_rows;

/* The member of a row in a config. Not for SHEARD_T_MEASURE. */
void *config_member(sheard_config *config, const sheard_setting *s);
const void *config_const_member(const sheard_config *config, const sheard_setting *s);

/* The section or key (of that section) nearest to a misspelt one, or NULL if none is near. */
const char *config_nearest_section(const char *name);
const char *config_nearest_key(const char *section, const char *key);

/* Another section that has this very key, or NULL. */
const char *config_section_of(const char *key);

#endif
