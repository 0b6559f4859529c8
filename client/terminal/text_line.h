/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text_line.h: one line "  NAME       TEXT", as reports for people are made of. */
#ifndef CLIENT_TERMINAL_TEXT_LINE_H
#define CLIENT_TERMINAL_TEXT_LINE_H

#include <stdio.h>

/* What is not printable in the text is shown as '?'. */
void text_line(FILE *out, const char *name, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
