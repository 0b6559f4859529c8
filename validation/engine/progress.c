/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/progress.h"

#include "base/clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { BAR = 24 };
static const double terminal_interval = 0.1;
static const double log_interval = 60.0;

static struct {
    bool visible, terminal, drawn;
    int64_t total, cached, done; /* stamps */
    double begun, shown;         /* monotonic seconds */
} p;

void progress_begin(int64_t total, bool quiet) {
    const char *term = getenv("TERM");
    p.total = total;
    p.visible = !quiet;
    p.terminal = isatty(STDERR_FILENO) && term != NULL && strcmp(term, "dumb") != 0;
    p.begun = p.shown = clock_s(CLOCK_MONOTONIC);
}

static void format_time(double seconds, char *buf, size_t size) {
    const long s = (long)(seconds + 0.5);
    if (s < 3600) {
        snprintf(buf, size, "%ld:%02ld", s / 60, s % 60);
    } else {
        snprintf(buf, size, "%ld:%02ld:%02ld", s / 3600, s / 60 % 60, s % 60);
    }
}

static void show(const char *label, double now) {
    char bar[BAR + 1] = "";
    char left[32] = "?";
    const double rate = (double)(p.done - p.cached) / (now - p.begun + 1e-9);
    const double part = p.total > 0 ? (double)p.done / (double)p.total : 0.0;
    memset(bar, '.', BAR);
    memset(bar, '#', (size_t)(BAR * (part < 1.0 ? part : 1.0)));
    if (rate > 0.0)
        format_time((double)(p.total - p.done) / rate, left, sizeof left);
    fprintf(stderr, "%s%-18.18s [%s] %5.1f %%  %.4g stamps/s  %s left%s", p.terminal ? "\r" : "",
            label, bar, 100.0 * part, rate, left, p.terminal ? "\x1b[K" : "\n");
    fflush(stderr);
    p.drawn = true;
    p.shown = now;
}

void progress_add(const char *label, int64_t stamps, bool cached) {
    const double now = clock_s(CLOCK_MONOTONIC);
    p.done += stamps;
    p.cached += cached ? stamps : 0;
    if (p.visible && now - p.shown >= (p.terminal ? terminal_interval : log_interval))
        show(label, now);
}

void progress_end(void) {
    if (p.drawn && p.terminal)
        fputs("\r\x1b[K", stderr);
    p.drawn = false;
}
