/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text_line.h: print one line "  NAME       TEXT" of a report. */
#pragma once

#include <stdio.h>

/* Print the line. Characters that are not printable are shown as '?'. */
void text_line(FILE *out, const char *name, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
