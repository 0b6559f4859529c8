/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ini_text.h: parse INI text into events. Only its source includes ini.h.
 *
 * What inih would silently skip or truncate is a fault here: control characters, lines too long for
 * it, text after a section's bracket, lines without '='. A line that begins with white space
 * continues the value of the key above it. ' ;' begins a comment after a value, ';' and '#' at the
 * beginning of a line. Comments may have any length. A byte order mark is skipped. */
#pragma once

#include "shear/error.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct ini_events {
    void *context;
    void (*section)(void *context, int line, const char *name);
    /* `continued`: the line continues the last key's value. */
    void (*value)(void *context, int line, const char *key, const char *value, bool continued);
    void (*fault)(void *context, int line, const char *advice, const char *message);
} ini_events;

/* Parse text[size], of any bytes. Return SHEAR_OK, also if there are faults, or SHEAR_E_NOMEM. */
int ini_text_read(const char *text, size_t size, const ini_events *events, shear_error *err);
