/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ini_text.h: INI text as events. Only its source sees ini.h.
 *
 * What inih would pass over in silence or chop is a fault here: control characters, lines too long
 * for it, text behind a section's bracket, lines without '='. A line that begins with white space
 * goes on with the value of the key above it. ' ;' begins a comment behind a value, ';' and '#' at
 * the beginning of a line. Comments may be of any length. A byte order mark is passed over.
 */
#ifndef CONFIG_INI_TEXT_H
#define CONFIG_INI_TEXT_H

#include "shear/error.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct ini_events {
    void *context;
    void (*section)(void *context, int line, const char *name);
    /* `continued`: this is a further line of the last key's value. */
    void (*value)(void *context, int line, const char *key, const char *value, bool continued);
    void (*fault)(void *context, int line, const char *advice, const char *message);
} ini_events;

/* Read text[size] (any bytes). SHEAR_OK also where there were faults; SHEAR_E_NOMEM. */
int ini_text_read(const char *text, size_t size, const ini_events *events, shear_error *err);

#endif
