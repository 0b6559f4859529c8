/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "timer.h"

#include <stdlib.h>
#include <time.h>

static double read_us(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

double timer_now_us(void) {
    return read_us(CLOCK_MONOTONIC);
}

double timer_processor_us(void) {
    return read_us(CLOCK_THREAD_CPUTIME_ID);
}

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

double timer_median(double *values, int n) {
    qsort(values, (size_t)n, sizeof *values, compare);
    return values[n / 2];
}
