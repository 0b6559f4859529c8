/* SPDX-License-Identifier: GPL-3.0-or-later */
/* log/repeats.h: detect messages that are repeated too often, and count them. */
#pragma once

#include "log/log.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { REPEATS_MESSAGES = 32, REPEATS_TEXT = 256 };

typedef struct repeated {
    uint64_t hash;           /* of the level and the whole text */
    int64_t since_ms;        /* when the interval began */
    unsigned seen, left_out; /* messages in the interval; seen 0: an unused entry */
    enum log_level level;
    char text[REPEATS_TEXT]; /* the beginning of the text */
} repeated;

typedef struct repeats {
    repeated items[REPEATS_MESSAGES];
} repeats;

/* Count a message. Return true if it is to be written: `burst` per `interval_ms` are. */
bool repeats_admit(repeats *r, enum log_level level, const char *text, unsigned burst,
                   int64_t interval_ms, int64_t now_ms);
/* Remove a message that was left out and whose interval is over (any such message if interval_ms is
 * 0), and copy it to *out. Return false if there is none. */
bool repeats_next_ended(repeats *r, int64_t interval_ms, int64_t now_ms, repeated *out);
