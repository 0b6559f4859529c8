/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report/advice_say.h: format a line of advice. */
#ifndef PROTOCOL_REPORT_ADVICE_SAY_H
#define PROTOCOL_REPORT_ADVICE_SAY_H

#include <stddef.h>

/* Format as snprintf does. Return buf. */
const char *advice_say(char *buf, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
