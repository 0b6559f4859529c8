/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bar.h: a progress bar as text, and the figures behind it. Pure functions. */
#ifndef CLIENT_TERMINAL_BAR_H
#define CLIENT_TERMINAL_BAR_H

#include <stddef.h>

/* "[####......]", `width` columns with its brackets (at least 3), in buf (more than width bytes);
 * returned. `part` outside of 0 to 1 is taken as the nearest. */
char *bar_text(double part, int width, char *buf, size_t size);

/* " 42% 12345 stamps/s 0:07 left"; a rate that is not known or 0 (then nothing is said of the time
 * left) is left out. `left_s` in seconds. Returns buf. */
char *bar_figures(double part, double rate, double left_s, char *buf, size_t size);

/* done / total; 1 where total is not more than done, 0 if it is not known (negative). */
double bar_part(double done, double total);

#endif
