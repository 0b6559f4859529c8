/* SPDX-License-Identifier: GPL-3.0-or-later */
/* human.h: times, durations, sizes and counts as people read and write them. Pure functions; those
 * that write return buf. */
#ifndef CLIENT_TERMINAL_HUMAN_H
#define CLIENT_TERMINAL_HUMAN_H

#include <stdbool.h>
#include <stdint.h>

enum { HUMAN_SIZE = 32 };

/* "2026-01-31 12:00:05", local time; in UTC with a Z at its end. "-" for 0 (absent). */
char *human_time(int64_t ms, bool utc, char buf[HUMAN_SIZE]);

/* "0.25 s", "12 s", "3 min 05 s", "2 h 07 min", "5 d 03 h"; "-" for what is negative or not finite.
 */
char *human_duration(double seconds, char buf[HUMAN_SIZE]);

/* From `since` to `now` as a duration, "just now" below a second; "-" where `since` is 0. */
char *human_age(int64_t since_ms, int64_t now_ms, char buf[HUMAN_SIZE]);

/* "512 B", "3.4 MiB". */
char *human_bytes(int64_t bytes, char buf[HUMAN_SIZE]);

/* "12345/s", "0.25/s"; "-" for what is not finite. */
char *human_rate(double per_second, char buf[HUMAN_SIZE]);

/* "90", "90s", "250ms", "5min", "2h", "1d": seconds. False for anything else. */
bool human_parse_duration(const char *text, double *seconds);

#endif
