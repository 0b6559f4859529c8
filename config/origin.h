/* SPDX-License-Identifier: GPL-3.0-or-later */
/* origin.h: set a setting by its index and record where its value comes from; report problems at
 * such places. */
#pragma once

#include "sheard/config.h"

/* Special entries of sheard_config.lines; positive entries are lines of the file. */
enum { ORIGIN_DEFAULT = 0, ORIGIN_COMMAND_LINE = -1, ORIGIN_EARLIER = -2 };

/* Set a value as sheard_config_set does, and record `line`. */
int config_set_at(sheard_config *config, size_t index, const char *text, int line,
                  shear_error *err);

/* Find the setting's index. The error for an unknown one suggests the nearest name. */
int config_find(const char *section, const char *key, size_t *index, shear_error *err);
/* Fill in the error of an unknown section, with the nearest name, and return its code. */
int config_unknown_section(const char *section, shear_error *err);

/* Return the index of a setting that exists. */
size_t config_at(const char *section, const char *key);

/* Describe where the setting comes from: "path:12", "command line", "default", or "earlier
 * configuration" for one that a reload could not change. Return buf. */
char *config_where(const sheard_config *config, size_t index, char *buf, size_t size);

/* Format "path:12"; a long path is cut at its beginning. Return buf. */
char *place_in_file(const char *path, int line, char *buf, size_t size);

/* Add a problem to the list; beyond SHEARD_PROBLEMS_KEPT it is only counted. problems_add returns
 * error->code; problems_warn is about a setting. */
int problems_add(sheard_problems *problems, const char *where, const shear_error *error);
void problems_warn(sheard_problems *problems, const sheard_config *config, size_t index,
                   const char *advice, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Load the file as sheard_config_load does; if `may_miss` is true, a missing file is not an error.
 */
int config_load_file(sheard_config *config, const char *path, bool may_miss,
                     sheard_problems *problems);
