/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/clock.h: the two clocks of the service. */
#ifndef SHEARD_SERVICE_CLOCK_H
#define SHEARD_SERVICE_CLOCK_H

#include "base/clock.h"

/* To tell and to store; it may be set at any time. */
static inline int64_t clock_wall_ms(void) {
    return clock_ms(CLOCK_REALTIME);
}

/* To measure with; it counts on while the machine sleeps. */
static inline int64_t clock_steady_ms(void) {
    return clock_ms(CLOCK_BOOTTIME);
}

#endif
