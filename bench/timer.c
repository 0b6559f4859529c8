/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "timer.h"

#include "base/clock.h"
#include "base/sort.h"

double timer_now_us(void) {
    return 1e-3 * (double)clock_ns(CLOCK_MONOTONIC);
}

double timer_processor_us(void) {
    return 1e-3 * (double)clock_ns(CLOCK_THREAD_CPUTIME_ID);
}

double timer_median(double *values, int n) {
    sort_doubles(values, (size_t)n);
    return values[n / 2];
}
