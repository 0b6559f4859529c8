/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/progress.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { BAR = 24 };
static const double terminal_interval = 0.1;
static const double log_interval = 60.0;

double progress_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void progress_begin(struct progress *p, int64_t total, bool quiet) {
    const char *term = getenv("TERM");
    *p = (struct progress){.total = total, .visible = !quiet};
    p->terminal = isatty(STDERR_FILENO) && term != NULL && strcmp(term, "dumb") != 0;
    p->begun = p->shown = progress_seconds();
}

static void format_time(double seconds, char *buf, size_t size) {
    long s = (long)(seconds + 0.5);
    if (s < 3600) {
        snprintf(buf, size, "%ld:%02ld", s / 60, s % 60);
    } else {
        snprintf(buf, size, "%ld:%02ld:%02ld", s / 3600, s / 60 % 60, s % 60);
    }
}

static void show(struct progress *p, const char *label, double now) {
    char bar[BAR + 1];
    char left[32] = "?";
    double rate = (double)(p->done - p->skipped) / (now - p->begun + 1e-9);
    double part = p->total > 0 ? (double)p->done / (double)p->total : 0.0;
    int filled = (int)(BAR * (part < 1.0 ? part : 1.0));
    memset(bar, '.', BAR);
    memset(bar, '#', (size_t)filled);
    bar[BAR] = '\0';
    if (rate > 0.0) {
        format_time((double)(p->total - p->done) / rate, left, sizeof left);
    }
    fprintf(stderr, "%s%-18.18s [%s] %5.1f %%  %.4g stamps/s  %s left%s", p->terminal ? "\r" : "",
            label, bar, 100.0 * part, rate, left, p->terminal ? "\x1b[K" : "\n");
    fflush(stderr);
    p->drawn = true;
    p->shown = now;
}

void progress_add(struct progress *p, const char *label, int64_t stamps, bool skipped) {
    double now = progress_seconds();
    p->done += stamps;
    p->skipped += skipped ? stamps : 0;
    if (p->visible && now - p->shown >= (p->terminal ? terminal_interval : log_interval)) {
        show(p, label, now);
    }
}

void progress_end(struct progress *p) {
    if (p->drawn && p->terminal) {
        fputs("\r\x1b[K", stderr);
    }
    p->drawn = false;
}
