/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/advice_say.h"

#include <stdarg.h>
#include <stdio.h>

const char *advice_say(char *buf, size_t size, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(buf, size, format, args);
    va_end(args);
    return buf;
}
