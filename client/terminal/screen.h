/* SPDX-License-Identifier: GPL-3.0-or-later */
/* screen.h: a terminal that is drawn on in place: the alternate screen, keys without Enter, and
 * everything as it was at the end, also after SIGINT, SIGTERM and SIGHUP. One at a time. */
#ifndef CLIENT_TERMINAL_SCREEN_H
#define CLIENT_TERMINAL_SCREEN_H

#include <stdbool.h>

/* Both standard input and output are a terminal that can do this. */
bool screen_possible(void);

void screen_begin(void);
void screen_end(void);

/* Draw `text` from the top, its lines cut to the terminal, the rest empty. */
void screen_draw(const char *text);

/* Wait for `seconds`, a key or a new size. True: the user wants to end (q, ^C, a signal). */
bool screen_wait(double seconds);
/* Only wait. */
bool screen_sleep(double seconds);

#endif
