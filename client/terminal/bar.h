/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bar.h: a progress bar as text, and the numbers after it. Pure functions. */
#pragma once

#include <stddef.h>

/* Write "[####......]", `width` columns (at least 3) with its brackets, into buf, which has room
 * for more than width bytes. `part` is clamped to [0, 1]. Returns buf. */
char *bar_text(double part, int width, char *buf, size_t size);

/* Write " 42% 12345 stamps/s 0:07 left" into buf. If the rate is unknown or 0, it and the time left
 * are omitted. `left_s` is in seconds. Returns buf. */
char *bar_figures(double part, double rate, double left_s, char *buf, size_t size);

/* Return done / total: 1 if total <= done, 0 if total is unknown (negative). */
double bar_part(double done, double total);
