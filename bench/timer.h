/* SPDX-License-Identifier: GPL-3.0-or-later */
/* timer.h: clock and median for the benchmarks. */
#pragma once

/* Return the time of the monotonic clock in microseconds. */
double timer_now_us(void);
/* Return this thread's processor time in microseconds; other processes do not affect it. */
double timer_processor_us(void);

/* Return the median of n > 0 values, which are sorted in place. */
double timer_median(double *values, int n);
