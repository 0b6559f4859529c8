/* SPDX-License-Identifier: GPL-3.0-or-later */
/* origin.h: setting by index, and remembering from where; the places that problems are reported at.
 */
#ifndef CONFIG_ORIGIN_H
#define CONFIG_ORIGIN_H

#include "sheard/config.h"

/* Entries of sheard_config.lines; positive ones are lines of the file. */
enum { ORIGIN_DEFAULT = 0, ORIGIN_COMMAND_LINE = -1, ORIGIN_EARLIER = -2 };

/* As sheard_config_set, and remember `line`. */
int config_set_at(sheard_config *config, size_t index, const char *text, int line,
                  shear_error *err);

/* The setting's index; the error of an unknown one names the nearest. */
int config_find(const char *section, const char *key, size_t *index, shear_error *err);
int config_unknown_section(const char *section, shear_error *err);

/* "path:12", "command line", "default", or "earlier configuration" for what a reload could not
 * change. Returns buf. */
char *config_where(const sheard_config *config, size_t index, char *buf, size_t size);

/* "path:12"; a long path keeps its end. Returns buf. */
char *place_in_file(const char *path, int line, char *buf, size_t size);

/* Add to the list; what does not fit is counted only. problems_add returns error->code. */
int problems_add(sheard_problems *problems, const char *where, const shear_error *error);
void problems_warn(sheard_problems *problems, const char *where, const char *advice,
                   const char *format, ...) __attribute__((format(printf, 4, 5)));

/* sheard_config_load; a file that is not there is no error where `may_miss`. */
int config_load_file(sheard_config *config, const char *path, bool may_miss,
                     sheard_problems *problems);

#endif
