/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "terminal/text_line.h"

#include "terminal/message.h"

#include <stdarg.h>

void text_line(FILE *out, const char *name, const char *format, ...) {
    char text[4200];
    char clean[4200];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    fprintf(out, "  %-10s %s\n", name, message_clean(text, clean, sizeof clean));
}
