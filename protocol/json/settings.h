/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json/settings.h: the measurement's settings as JSON. */
#ifndef PROTOCOL_JSON_SETTINGS_H
#define PROTOCOL_JSON_SETTINGS_H

#include "shear/settings.h"

#include <jansson.h>

/* {"NAME": value, ...} for every setting of the table, in native types, "auto" as a string. A new
 * reference; NULL: memory is out. */
json_t *json_settings(const shear_settings *s);

#endif
