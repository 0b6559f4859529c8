/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json/settings.h: write the measurement's settings as a JSON object. */
#pragma once

#include "shear/settings.h"

#include <jansson.h>

/* Return {"NAME": value, ...} for every setting of the table, in native types, with "auto" as a
 * string: a new reference, or NULL if out of memory. */
json_t *json_settings(const shear_settings *s);
