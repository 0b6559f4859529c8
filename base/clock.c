/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/clock.h"

static struct timespec now(clockid_t clock) {
    struct timespec t = {0};
    clock_gettime(clock, &t);
    return t;
}

int64_t clock_ns(clockid_t clock) {
    const struct timespec t = now(clock);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

int64_t clock_us(clockid_t clock) {
    const struct timespec t = now(clock);
    return (int64_t)t.tv_sec * 1000000 + t.tv_nsec / 1000;
}

int64_t clock_ms(clockid_t clock) {
    const struct timespec t = now(clock);
    return (int64_t)t.tv_sec * 1000 + t.tv_nsec / 1000000;
}

double clock_s(clockid_t clock) {
    const struct timespec t = now(clock);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
