/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/clock.h: the time of a POSIX clock in the unit that is wanted.
 *
 * CLOCK_REALTIME is the wall clock's, since 1970: what is told and stored. CLOCK_MONOTONIC and
 * CLOCK_BOOTTIME are never set: what is waited for. CLOCK_THREAD_CPUTIME_ID is what the calling
 * thread has worked. Whole units are rounded down. */
#ifndef BASE_CLOCK_H
#define BASE_CLOCK_H

#include <stdint.h>
#include <time.h>

int64_t clock_ns(clockid_t clock);
int64_t clock_us(clockid_t clock);
int64_t clock_ms(clockid_t clock);
double clock_s(clockid_t clock);

#endif
