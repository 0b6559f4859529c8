/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How long a turn of the loop takes: everybody waits for it. In processor time of the loop's
 * thread, so that it tells of the service and not of the machine's other work, nor of a slow disk.
 */
#include "service/inner.h"

#include <time.h>

static int64_t thread_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

/* Before the loop waits: from one of these to the next is a turn. */
static void on_mark(uv_prepare_t *mark) {
    service *s = mark->data;
    const int64_t now = thread_ns();
    const int64_t turn = s->marked_ns != 0 ? now - s->marked_ns : 0;
    int64_t *lately = &s->longest_at[s->ticks % RATE_SLOTS];
    s->marked_ns = now;
    s->longest_ns = turn > s->longest_ns ? turn : s->longest_ns;
    *lately = turn > *lately ? turn : *lately;
}

void pace_start(service *s) {
    uv_prepare_init(&s->loop, &s->mark);
    s->mark.data = s;
    uv_prepare_start(&s->mark, on_mark);
}

void pace_tick(service *s) {
    s->longest_at[s->ticks % RATE_SLOTS] = 0;
}

sheard_msg_loop pace_tell(const service *s) {
    server_statistics net;
    int64_t lately = 0;
    for (int i = 0; i < RATE_SLOTS; i++) {
        lately = s->longest_at[i] > lately ? s->longest_at[i] : lately;
    }
    server_get_statistics(s->server, &net);
    return (sheard_msg_loop){.longest_ms = 1e-6 * (double)s->longest_ns,
                             .longest_minute_ms = 1e-6 * (double)lately,
                             .unsent_bytes = (int64_t)net.unsent_bytes,
                             .dropped = (int64_t)net.dropped};
}
