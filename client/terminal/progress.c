/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "terminal/progress.h"
#include "base/clock.h"

#include "terminal/bar.h"
#include "terminal/message.h"
#include "terminal/style.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

enum { REFRESH_MS = 100, DEFAULT_WIDTH = 80, MAX_WIDTH = 200, MIN_BAR = 4 };

typedef struct progress {
    char label[40];
    bool visible; /* standard error is a terminal that can redraw a line */
    bool drawn;
    double begun, refreshed; /* monotonic seconds */
    struct sigaction old_int, old_term;
} progress;

static volatile sig_atomic_t interrupted;

static void on_signal(int number) {
    (void)number;
    interrupted = 1;
}

void progress_interrupt(void) {
    interrupted = 1;
}

bool progress_interrupted(void) {
    return interrupted != 0;
}

static void catch_signals(progress *p) {
    struct sigaction action = {.sa_handler = on_signal};
    /* SA_RESETHAND: a second signal ends a process that does not react to the first one. */
    action.sa_flags = (int)SA_RESETHAND | SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, NULL, &p->old_int);
    sigaction(SIGTERM, NULL, &p->old_term);
    /* A signal that is ignored from the start (nohup, a shell's background job) stays ignored. */
    if (p->old_int.sa_handler != SIG_IGN)
        sigaction(SIGINT, &action, NULL);
    if (p->old_term.sa_handler != SIG_IGN)
        sigaction(SIGTERM, &action, NULL);
}

progress *progress_begin(const char *label, bool quiet) {
    progress *p = calloc(1, sizeof *p);
    if (p != NULL) {
        p->begun = clock_s(CLOCK_MONOTONIC);
        p->visible = !quiet && style_is_terminal(STDERR_FILENO);
        message_clean(label, p->label, sizeof p->label);
        catch_signals(p);
    }
    return p;
}

static int terminal_width(void) {
    struct winsize size;
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
        return DEFAULT_WIDTH;
    return size.ws_col < MAX_WIDTH ? size.ws_col : MAX_WIDTH;
}

/* Draw "label [####....] figures", or as much of the figures as fits. */
static void paint(progress *p, double part, const char *figures, double now) {
    const int width = terminal_width() - 1; /* a full line would wrap on some terminals */
    const int bar = width - (int)strlen(p->label) - (int)strlen(figures) - 1;
    if (bar >= MIN_BAR + 2) {
        char text[MAX_WIDTH + 1];
        fprintf(stderr, "\r%s %s%s", p->label, bar_text(part, bar, text, sizeof text), figures);
    } else {
        fprintf(stderr, "\r%.*s", width, figures + 1);
    }
    fputs("\x1b[K", stderr); /* erase the rest of a longer line */
    fflush(stderr);
    p->drawn = true;
    p->refreshed = now;
}

static bool is_due(const progress *p, double now) {
    return p != NULL && p->visible && 1000.0 * (now - p->refreshed) >= REFRESH_MS;
}

static void draw(progress *p, int64_t done, int64_t total, double rate, double now) {
    char figures[96];
    const double part = bar_part((double)done, (double)total);
    if (total < 0) {
        snprintf(figures, sizeof figures, " waiting");
    } else {
        bar_figures(part, rate, (double)(total - done) / rate, figures, sizeof figures);
    }
    paint(p, part, figures, now);
}

int progress_callback(void *context, int64_t done, int64_t total) {
    progress *p = context;
    const double now = clock_s(CLOCK_MONOTONIC);
    if (is_due(p, now))
        draw(p, done, total, now > p->begun ? (double)done / (now - p->begun) : 0.0, now);
    return interrupted != 0;
}

void progress_show(progress *p, const char *label, int64_t done, int64_t total, double rate) {
    const double now = clock_s(CLOCK_MONOTONIC);
    if (is_due(p, now)) {
        message_clean(label, p->label, sizeof p->label);
        draw(p, done, total, rate, now);
    }
}

bool progress_visible(const progress *p) {
    return p != NULL && p->visible;
}

void progress_end(progress *p) {
    if (p == NULL)
        return;
    if (p->drawn) {
        fputs("\r\x1b[K", stderr);
        fflush(stderr);
    }
    sigaction(SIGINT, &p->old_int, NULL);
    sigaction(SIGTERM, &p->old_term, NULL);
    free(p);
}
