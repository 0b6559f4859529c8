/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/report.h"

#include "spool/internal.h"

#include <stdarg.h>
#include <stdio.h>

void report_line(const spool *s, enum spool_level level, const char *format, ...) {
    char text[1024];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    s->call.log(s->call.context, level, text);
}

void report_trouble(spool *s, const char *format, ...) {
    va_list list;
    if (s->trouble[0] == '\0')
        s->trouble_since_ms = s->call.now_ms(s->call.context);
    va_start(list, format);
    vsnprintf(s->trouble, sizeof s->trouble, format, list);
    va_end(list);
}

void report_no_trouble(spool *s) {
    s->trouble[0] = '\0';
}
