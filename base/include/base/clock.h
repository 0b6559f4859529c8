/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/clock.h: the time of a POSIX clock in seconds, ms, us or ns.
 *
 * CLOCK_REALTIME is the wall clock, since 1970, for times that are reported and stored.
 * CLOCK_MONOTONIC and CLOCK_BOOTTIME cannot be set, and serve timeouts and durations.
 * CLOCK_THREAD_CPUTIME_ID is the CPU time of the calling thread. Whole units are rounded down. */
#pragma once

#include <stdint.h>
#include <time.h>

int64_t clock_ns(clockid_t clock);
int64_t clock_us(clockid_t clock);
int64_t clock_ms(clockid_t clock);
double clock_s(clockid_t clock);
