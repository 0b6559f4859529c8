/* SPDX-License-Identifier: GPL-3.0-or-later */
/* log/repeats.h: which messages have come too often. */
#ifndef LOG_REPEATS_H
#define LOG_REPEATS_H

#include "log/log.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { REPEATS_MESSAGES = 32, REPEATS_TEXT = 256 };

typedef struct repeated {
    uint64_t hash;           /* of level and whole text */
    int64_t since_ms;        /* the interval began */
    unsigned seen, left_out; /* in it; seen 0: a free place */
    enum log_level level;
    char text[REPEATS_TEXT]; /* its beginning */
} repeated;

typedef struct repeats {
    repeated items[REPEATS_MESSAGES];
} repeats;

/* Count it; true: write it. `burst` in `interval_ms` are to be written. */
bool repeats_admit(repeats *r, enum log_level level, const char *text, unsigned burst,
                   int64_t interval_ms, int64_t now_ms);
/* A message that was left out and whose interval is over (or any, where interval_ms is 0): it is
 * forgotten, and *out a copy. False: there is none. */
bool repeats_next_ended(repeats *r, int64_t interval_ms, int64_t now_ms, repeated *out);

#endif
