/* SPDX-License-Identifier: GPL-3.0-or-later */
/* timer.h: the clock of the benchmarks. */
#ifndef BENCH_TIMER_H
#define BENCH_TIMER_H

double timer_now_us(void);
/* Time that this thread has had a processor: what others do meanwhile does not count. */
double timer_processor_us(void);

/* The middle one of n > 0 values, which are put in order. */
double timer_median(double *values, int n);

#endif
