/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Convert times between milliseconds since 1970, UTC, and RFC 3339. */
#include "sheard/messages.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

enum { LAST_YEAR = 9999 };

/* The first millisecond of year 0 and the last of year 9999: the range of four digits. */
static const int64_t earliest = INT64_C(-62167219200000), latest = INT64_C(253402300799999);

char *sheard_time_format(int64_t ms, char buf[SHEARD_TIME_SIZE]) {
    const int64_t kept = ms < earliest ? earliest : ms > latest ? latest : ms;
    int64_t seconds = kept / 1000;
    int64_t rest = kept % 1000;
    if (rest < 0) {
        rest += 1000;
        seconds--;
    }
    const time_t t = (time_t)seconds;
    struct tm tm;
    gmtime_r(&t, &tm);
    snprintf(buf, SHEARD_TIME_SIZE, "%04u-%02u-%02uT%02u:%02u:%02u.%03uZ",
             (unsigned)(tm.tm_year + 1900) % 10000U, (unsigned)(tm.tm_mon + 1) % 100U,
             (unsigned)tm.tm_mday % 100U, (unsigned)tm.tm_hour % 100U, (unsigned)tm.tm_min % 100U,
             (unsigned)tm.tm_sec % 100U, (unsigned)rest % 1000U);
    return buf;
}

/* Read a number of exactly `digits` digits. Return false if they are not there. */
static bool read_number(const char **text, int digits, int *value) {
    *value = 0;
    for (int i = 0; i < digits; i++, (*text)++) {
        if (**text < '0' || **text > '9')
            return false;
        *value = *value * 10 + (**text - '0');
    }
    return true;
}

static bool read_char(const char **text, char a, char b) {
    if (**text != a && **text != b)
        return false;
    (*text)++;
    return true;
}

static bool read_date(const char **text, struct tm *tm) {
    return read_number(text, 4, &tm->tm_year) && read_char(text, '-', '-') &&
           read_number(text, 2, &tm->tm_mon) && read_char(text, '-', '-') &&
           read_number(text, 2, &tm->tm_mday) && read_char(text, 'T', 't') &&
           read_number(text, 2, &tm->tm_hour) && read_char(text, ':', ':') &&
           read_number(text, 2, &tm->tm_min) && read_char(text, ':', ':') &&
           read_number(text, 2, &tm->tm_sec);
}

/* Check a date. A leap second (:60) counts as the second after :59. */
static bool date_is_real(const struct tm *tm) {
    static const int days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    const int y = tm->tm_year;
    const bool leap = (y % 4 == 0 && y % 100 != 0) || y % 400 == 0;
    return y <= LAST_YEAR && tm->tm_mon >= 1 && tm->tm_mon <= 12 && tm->tm_mday >= 1 &&
           tm->tm_mday <= days[tm->tm_mon - 1] + (leap && tm->tm_mon == 2) && tm->tm_hour <= 23 &&
           tm->tm_min <= 59 && tm->tm_sec <= 60;
}

/* Read ".25" as milliseconds; further digits are ignored, and no fraction is 0. */
static bool read_fraction(const char **text, int *ms) {
    *ms = 0;
    if (**text != '.')
        return true;
    const char *first = ++*text;
    for (int unit = 100; **text >= '0' && **text <= '9'; (*text)++, unit /= 10)
        *ms += unit * (**text - '0');
    return *text > first;
}

/* Read "Z" or "+01:30" as seconds. */
static bool read_offset(const char **text, int *seconds) {
    *seconds = 0;
    if (read_char(text, 'Z', 'z'))
        return true;
    const int sign = **text == '-' ? -1 : 1;
    int hours = 0;
    int minutes = 0;
    if (!read_char(text, '+', '-') || !read_number(text, 2, &hours) || !read_char(text, ':', ':') ||
        !read_number(text, 2, &minutes) || hours > 23 || minutes > 59) {
        return false;
    }
    *seconds = sign * (hours * 3600 + minutes * 60);
    return true;
}

bool sheard_time_parse(int64_t *ms, const char *text) {
    struct tm tm = {0};
    int fraction = 0;
    int offset = 0;
    *ms = 0;
    if (!read_date(&text, &tm) || !date_is_real(&tm) || !read_fraction(&text, &fraction) ||
        !read_offset(&text, &offset) || *text != '\0') {
        return false;
    }
    tm.tm_year -= 1900;
    tm.tm_mon -= 1;
    *ms = ((int64_t)timegm(&tm) - offset) * 1000 + fraction;
    return true;
}
