/* SPDX-License-Identifier: GPL-3.0-or-later */
/* human.h: times, durations, sizes, rates and measured values as text. Pure functions; those that
 * write into buf return buf. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { HUMAN_SIZE = 32 };

/* Write "2026-01-31 12:00:05" in local time, or in UTC with a final Z; "-" if ms is 0 (absent). */
char *human_time(int64_t ms, bool utc, char buf[HUMAN_SIZE]);

/* Write "0.25 s", "12 s", "3 min 05 s", "2 h 07 min" or "5 d 03 h"; "-" if negative or not finite.
 */
char *human_duration(double seconds, char buf[HUMAN_SIZE]);

/* Write the time from `since` to `now` as a duration; "just now" below a second, "-" if `since` is
 * 0. */
char *human_age(int64_t since_ms, int64_t now_ms, char buf[HUMAN_SIZE]);

/* Write "512 B" or "3.4 MiB". */
char *human_bytes(int64_t bytes, char buf[HUMAN_SIZE]);

/* Write "12345/s" or "0.25/s"; "-" if not finite. */
char *human_rate(double per_second, char buf[HUMAN_SIZE]);

/* Parse "90", "90s", "250ms", "5min", "2h" or "1d" into seconds. Returns false for anything else.
 */
bool human_parse_duration(const char *text, double *seconds);

/* Write "+0.02852 +- 0.00080" into buf: the error with two digits, the value with the same
 * decimals; "-" if the value is not finite. */
char *human_value(double value, double error, char *buf, size_t size);
/* Return the number of decimals that show two digits of the error. */
int human_decimals(double error);
