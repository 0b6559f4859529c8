/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "terminal/screen.h"
#include "base/clock.h"

#include "terminal/progress.h"
#include "terminal/style.h"

#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

enum { DEFAULT_COLUMNS = 80, DEFAULT_ROWS = 24, N_SIGNALS = 4 };

static const int signals[N_SIGNALS] = {SIGINT, SIGTERM, SIGHUP, SIGWINCH};
static volatile sig_atomic_t ended, resized;
static struct sigaction old_actions[N_SIGNALS];
static struct termios old_terminal;

static void on_signal(int number) {
    if (number == SIGWINCH) {
        resized = 1;
    } else {
        ended = 1;
        progress_interrupt(); /* ends the current request to the service */
    }
}

bool screen_possible(void) {
    return style_is_terminal(STDIN_FILENO) && isatty(STDOUT_FILENO) != 0;
}

void screen_begin(void) {
    struct sigaction action = {.sa_handler = on_signal};
    sigemptyset(&action.sa_mask);
    for (int i = 0; i < N_SIGNALS; i++)
        sigaction(signals[i], &action, &old_actions[i]);
    tcgetattr(STDIN_FILENO, &old_terminal);
    struct termios raw = old_terminal;
    raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
    tcsetattr(STDIN_FILENO, TCSADRAIN, &raw);
    fputs("\x1b[?1049h\x1b[?25l", stdout); /* alternate screen, no cursor */
    fflush(stdout);
}

void screen_end(void) {
    fputs("\x1b[?25h\x1b[?1049l", stdout);
    fflush(stdout);
    tcsetattr(STDIN_FILENO, TCSADRAIN, &old_terminal);
    for (int i = 0; i < N_SIGNALS; i++)
        sigaction(signals[i], &old_actions[i], NULL);
}

void screen_draw(const char *text) {
    resized = 0; /* before reading the size: a later change causes another redraw */
    const int columns = style_columns(STDOUT_FILENO, DEFAULT_COLUMNS);
    const int rows = style_rows(STDOUT_FILENO, DEFAULT_ROWS);
    fputs("\x1b[H", stdout);
    for (int row = 0; row < rows && *text != '\0'; row++) {
        char line[4096];
        const size_t n = strcspn(text, "\n");
        snprintf(line, sizeof line, "%.*s", (int)n, text);
        /* The last row has no newline, which would scroll the screen. */
        printf("%s%.*s\x1b[0m\x1b[K", row != 0 ? "\n" : "", (int)style_fit(line, columns), line);
        text += n + (text[n] == '\n');
    }
    fputs("\x1b[J", stdout);
    fflush(stdout);
}

static bool wants_end(void) {
    char keys[64];
    const ssize_t n = read(STDIN_FILENO, keys, sizeof keys);
    return n == 0 || (n > 0 && (memchr(keys, 'q', (size_t)n) != NULL ||
                                memchr(keys, 'Q', (size_t)n) != NULL));
}

/* A signal just before poll() is noticed after one slice. */
enum { SLICE_MS = 200 };

bool screen_wait(double seconds, bool keys) {
    struct pollfd p = {.fd = keys ? STDIN_FILENO : -1, .events = POLLIN};
    const double end = clock_s(CLOCK_MONOTONIC) + seconds;
    while (ended == 0 && resized == 0) {
        const double left_ms = 1000.0 * (end - clock_s(CLOCK_MONOTONIC));
        if (left_ms <= 0.0)
            break;
        if (poll(&p, 1, left_ms < SLICE_MS ? (int)left_ms + 1 : SLICE_MS) > 0)
            return wants_end();
    }
    return ended != 0;
}
