/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report/advice_say.h: format a line of advice. */
#pragma once

#include <stddef.h>

/* Format as snprintf does. Return buf. */
const char *advice_say(char *buf, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
