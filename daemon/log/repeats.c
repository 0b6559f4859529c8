/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "log/repeats.h"

#include <stdio.h>

/* Return the FNV-1a hash. */
static uint64_t hash_of(enum log_level level, const char *text) {
    uint64_t h = UINT64_C(14695981039346656037) ^ (uint64_t)level;
    for (const unsigned char *p = (const unsigned char *)text; *p != '\0'; p++)
        h = (h ^ *p) * UINT64_C(1099511628211);
    return h;
}

/* Return whether the interval is over. It also is if the clock was set back. */
static bool is_over(const repeated *m, int64_t interval_ms, int64_t now_ms) {
    return now_ms < m->since_ms || now_ms - m->since_ms >= interval_ms;
}

/* Return the message's entry, or one for it: an unused one, or else the oldest of those without a
 * count to be written; NULL if there is none. */
static repeated *place_of(repeats *r, uint64_t hash) {
    repeated *best = NULL;
    for (size_t i = 0; i < REPEATS_MESSAGES; i++) {
        repeated *m = &r->items[i];
        if (m->seen > 0 && m->hash == hash)
            return m;
        if (m->left_out == 0 &&
            (best == NULL || (best->seen > 0 && (m->seen == 0 || m->since_ms < best->since_ms)))) {
            best = m;
        }
    }
    return best;
}

bool repeats_admit(repeats *r, enum log_level level, const char *text, unsigned burst,
                   int64_t interval_ms, int64_t now_ms) {
    const uint64_t hash = hash_of(level, text);
    repeated *m = place_of(r, hash);
    if (m == NULL)
        return true;
    if (m->seen == 0 || m->hash != hash || is_over(m, interval_ms, now_ms)) {
        *m = (repeated){.hash = hash, .since_ms = now_ms, .level = level};
        snprintf(m->text, sizeof m->text, "%s", text);
    }
    m->seen++;
    if (m->seen > burst) {
        m->left_out++;
        return false;
    }
    return true;
}

bool repeats_next_ended(repeats *r, int64_t interval_ms, int64_t now_ms, repeated *out) {
    for (size_t i = 0; i < REPEATS_MESSAGES; i++) {
        repeated *m = &r->items[i];
        if (m->left_out > 0 && is_over(m, interval_ms, now_ms)) {
            *out = *m;
            *m = (repeated){0};
            return true;
        }
    }
    return false;
}
