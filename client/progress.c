/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "progress.h"

#include "message.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

enum { REFRESH_MS = 100, DEFAULT_WIDTH = 80, MAX_WIDTH = 200, MIN_BAR = 4 };

struct progress {
    char label[40];
    bool visible; /* standard error is a terminal that can redraw a line */
    bool drawn;
    double begun, refreshed; /* monotonic seconds */
    struct sigaction old_int, old_term;
};

static volatile sig_atomic_t interrupted;

static void on_signal(int number) {
    (void)number;
    interrupted = 1;
}

bool progress_interrupted(void) {
    return interrupted != 0;
}

static double now_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void take_signals(struct progress *p) {
    struct sigaction action = {.sa_handler = on_signal};
    /* SA_RESETHAND: a second signal ends a process that does not get round to the first one. */
    action.sa_flags = (int)SA_RESETHAND | SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, NULL, &p->old_int);
    sigaction(SIGTERM, NULL, &p->old_term);
    /* Who starts us with a signal ignored (nohup, a shell's background job) wants it ignored. */
    if (p->old_int.sa_handler != SIG_IGN) {
        sigaction(SIGINT, &action, NULL);
    }
    if (p->old_term.sa_handler != SIG_IGN) {
        sigaction(SIGTERM, &action, NULL);
    }
}

struct progress *progress_begin_quiet(void) {
    struct progress *p = calloc(1, sizeof *p);
    if (p) {
        p->begun = now_seconds();
        take_signals(p);
    }
    return p;
}

struct progress *progress_begin(const char *label) {
    struct progress *p = progress_begin_quiet();
    if (p) {
        const char *term = getenv("TERM");
        p->visible = isatty(STDERR_FILENO) && term && strcmp(term, "dumb") != 0;
        message_clean(label, p->label, sizeof p->label);
    }
    return p;
}

static int terminal_width(void) {
    struct winsize size;
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) {
        return DEFAULT_WIDTH;
    }
    return size.ws_col < MAX_WIDTH ? size.ws_col : MAX_WIDTH;
}

/* " 42% 12345/s 0:07 left" */
static void format_figures(double part, double rate, double left, char *buf, size_t size) {
    int64_t s = left < 359999.0 ? (int64_t)left : 359999;
    if (s < 3600) {
        snprintf(buf, size, " %3d%% %.0f stamps/s %" PRId64 ":%02" PRId64 " left",
                 (int)(100.0 * part), rate, s / 60, s % 60);
    } else {
        snprintf(buf, size, " %3d%% %.0f stamps/s %" PRId64 ":%02" PRId64 ":%02" PRId64 " left",
                 (int)(100.0 * part), rate, s / 3600, s / 60 % 60, s % 60);
    }
}

static void draw(struct progress *p, int64_t done, int64_t total, double now) {
    char figures[96];
    double part = total > done && done >= 0 ? (double)done / (double)total : 1.0;
    double rate = now > p->begun ? (double)done / (now - p->begun) : 0.0;
    format_figures(part, rate, rate > 0.0 ? (double)(total - done) / rate : 0.0, figures,
                   sizeof figures);
    int width = terminal_width() - 1; /* a full line would wrap on some terminals */
    int bar = width - (int)strlen(p->label) - (int)strlen(figures) - 3;
    if (bar >= MIN_BAR) {
        char marks[MAX_WIDTH + 1];
        int full = (int)(part * bar);
        memset(marks, '#', (size_t)full);
        memset(marks + full, '.', (size_t)(bar - full));
        marks[bar] = '\0';
        fprintf(stderr, "\r%s [%s]%s", p->label, marks, figures);
    } else {
        fprintf(stderr, "\r%.*s", width, figures + 1);
    }
    fputs("\x1b[K", stderr); /* erase what a longer line left */
    fflush(stderr);
    p->drawn = true;
    p->refreshed = now;
}

int progress_callback(void *progress, int64_t done, int64_t total) {
    struct progress *p = progress;
    if (p && p->visible) {
        double now = now_seconds();
        if (1000.0 * (now - p->refreshed) >= REFRESH_MS) {
            draw(p, done, total, now);
        }
    }
    return interrupted != 0;
}

void progress_end(struct progress *p) {
    if (!p) {
        return;
    }
    if (p->drawn) {
        fputs("\r\x1b[K", stderr);
        fflush(stderr);
    }
    sigaction(SIGINT, &p->old_int, NULL);
    sigaction(SIGTERM, &p->old_term, NULL);
    free(p);
}
