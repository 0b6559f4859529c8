/* SPDX-License-Identifier: GPL-3.0-or-later */
/* screen.h: full-screen output: the alternate screen, single key presses, and restoration of the
 * terminal at the end, also after SIGINT, SIGTERM and SIGHUP. One screen at a time. */
#pragma once

#include <stdbool.h>

/* Return whether standard input and output are a terminal with these features. */
bool screen_possible(void);

/* Switch to the alternate screen; restore the terminal. */
void screen_begin(void);
void screen_end(void);

/* Draw `text` from the top, with lines cut to the width; the rest of the screen is cleared. */
void screen_draw(const char *text);

/* Wait for `seconds`, a resize or, with `keys`, a key press. Returns true if the user wants to quit
 * (q, ^C, a signal). */
bool screen_wait(double seconds, bool keys);
