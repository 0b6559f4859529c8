/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ini_text.h: parse INI text into events.
 *
 * A line is a [section], "key = value" or "key: value", or empty. One that begins with white space
 * continues the value of the key above it, if there is one in the section. ' ;' begins a comment
 * after a value, ';' and '#' at the beginning of a line. A comment may have any length, another
 * line INI_LINE_MAX bytes. A byte order mark is skipped. All else is a fault: control characters,
 * lines that are too long, text after a section's bracket, lines without '='. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { INI_LINE_MAX = 198 };

typedef struct ini_events {
    void *context;
    void (*section)(void *context, int line, const char *name);
    /* `key` is NULL if the line continues the last key's value. */
    void (*value)(void *context, int line, const char *key, const char *value);
    void (*fault)(void *context, int line, const char *advice, const char *message);
} ini_events;

/* Parse text[size], of any bytes. */
void ini_text_read(const char *text, size_t size, const ini_events *events);
