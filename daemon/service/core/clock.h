/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/clock.h: the two clocks of the service, in milliseconds. */
#pragma once

#include "base/clock.h"

/* Return the wall clock, since 1970, for times that are shown or stored. It may be set at any
 * time. */
static inline int64_t clock_wall_ms(void) {
    return clock_ms(CLOCK_REALTIME);
}

/* Return the steady clock, for measuring intervals. It is never set, and counts while the machine
 * sleeps. */
static inline int64_t clock_steady_ms(void) {
    return clock_ms(CLOCK_BOOTTIME);
}
