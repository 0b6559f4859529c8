/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/warnings.h"

#include "base/array.h"

#include "terminal/message.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void warnings_add(warning_list *w, const char *format, ...) {
    char line[640];
    va_list args;
    va_start(args, format);
    vsnprintf(line, sizeof line, format, args);
    va_end(args);
    char *kept = strdup(line);
    if (kept == NULL || !ARRAY_RESERVE(w->text, w->capacity, w->n + 1)) {
        message_warning("%s", line);
        free(kept);
        return;
    }
    w->text[w->n++] = kept;
}

void warnings_print(const warning_list *w, const char *field) {
    for (size_t i = 0; i < w->n; i++)
        message_warning("field %s: %s", field, w->text[i]);
}

void warnings_deinit(warning_list *w) {
    for (size_t i = 0; i < w->n; i++)
        free(w->text[i]);
    free(w->text);
    *w = (warning_list){0};
}
