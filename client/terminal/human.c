/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "terminal/human.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MINUTE = 60, HOUR = 3600, DAY = 86400 };

static char *nothing(char buf[HUMAN_SIZE]) {
    snprintf(buf, HUMAN_SIZE, "-");
    return buf;
}

char *human_time(int64_t ms, bool utc, char buf[HUMAN_SIZE]) {
    const time_t t = (time_t)(ms / 1000);
    struct tm parts;
    if (ms <= 0 || (utc ? gmtime_r(&t, &parts) : localtime_r(&t, &parts)) == NULL ||
        strftime(buf, HUMAN_SIZE, utc ? "%Y-%m-%d %H:%M:%SZ" : "%Y-%m-%d %H:%M:%S", &parts) == 0) {
        return nothing(buf);
    }
    return buf;
}

char *human_duration(double seconds, char buf[HUMAN_SIZE]) {
    if (!isfinite(seconds) || seconds < 0.0)
        return nothing(buf);
    const int64_t s = seconds < 1e15 ? llround(seconds) : INT64_C(1000000000000000);
    if (seconds < 9.95) { /* 9.95 would become 10.0 */
        snprintf(buf, HUMAN_SIZE, seconds < 0.995 ? "%.2f s" : "%.1f s", seconds);
    } else if (s < MINUTE) {
        snprintf(buf, HUMAN_SIZE, "%" PRId64 " s", s);
    } else if (s < HOUR) {
        snprintf(buf, HUMAN_SIZE, "%" PRId64 " min %02" PRId64 " s", s / MINUTE, s % MINUTE);
    } else if (s < DAY) {
        snprintf(buf, HUMAN_SIZE, "%" PRId64 " h %02" PRId64 " min", s / HOUR, s % HOUR / MINUTE);
    } else {
        snprintf(buf, HUMAN_SIZE, "%" PRId64 " d %02" PRId64 " h", s / DAY, s % DAY / HOUR);
    }
    return buf;
}

char *human_age(int64_t since_ms, int64_t now_ms, char buf[HUMAN_SIZE]) {
    if (since_ms <= 0)
        return nothing(buf);
    const int64_t age = now_ms - since_ms;
    if (age < 1000) { /* the service's clock may be slightly ahead */
        snprintf(buf, HUMAN_SIZE, "just now");
        return buf;
    }
    if (age < 10000) { /* an age needs no tenths */
        snprintf(buf, HUMAN_SIZE, "%" PRId64 " s", age / 1000);
        return buf;
    }
    return human_duration((double)age / 1000.0, buf);
}

char *human_bytes(int64_t bytes, char buf[HUMAN_SIZE]) {
    static const char *const units[] = {"B", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
    double value = (double)bytes;
    size_t i = 0;
    while (value >= 1023.95 && i + 1 < sizeof units / sizeof *units) {
        value /= 1024.0;
        i++;
    }
    snprintf(buf, HUMAN_SIZE, i == 0 ? "%.0f %s" : "%.1f %s", value, units[i]);
    return buf;
}

char *human_rate(double per_second, char buf[HUMAN_SIZE]) {
    if (!isfinite(per_second))
        return nothing(buf);
    snprintf(buf, HUMAN_SIZE, per_second < 9.995 ? "%.2f/s" : "%.0f/s", per_second);
    return buf;
}

bool human_parse_duration(const char *text, double *seconds) {
    static const struct {
        const char *name;
        double seconds;
    } units[] = {{"", 1.0}, {"s", 1.0}, {"ms", 1e-3}, {"min", MINUTE}, {"h", HOUR}, {"d", DAY}};
    char *end = NULL;
    if (*text < '0' || *text > '9') { /* strtod also accepts signs, spaces and "inf" */
        return false;
    }
    const double value = strtod(text, &end);
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        if (strcmp(end, units[i].name) == 0 && isfinite(value * units[i].seconds)) {
            *seconds = value * units[i].seconds;
            return true;
        }
    }
    return false;
}

/* Shears are compared at the level of 1e-5, even if the error of a single field is larger. */
enum { MIN_DECIMALS = 5, MAX_DECIMALS = 12 };

int human_decimals(double error) {
    if (!isfinite(error) || error <= 0.0)
        return 6;
    int decimals = 1 - (int)floor(log10(error));
    return decimals < MIN_DECIMALS   ? MIN_DECIMALS
           : decimals > MAX_DECIMALS ? MAX_DECIMALS
                                     : decimals;
}

char *human_value(double value, double error, char *buf, size_t size) {
    const int decimals = human_decimals(error);
    if (isfinite(value)) {
        snprintf(buf, size, "%+.*f +- %.*f", decimals, value, decimals, error);
    } else {
        snprintf(buf, size, "-");
    }
    return buf;
}
