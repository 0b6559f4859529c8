/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/rates.h: how much was done in the last minute. */
#ifndef SHEARD_SERVICE_RATES_H
#define SHEARD_SERVICE_RATES_H

#include "sheard/messages.h"

#include <stdint.h>

enum { RATE_SLOTS = 61 }; /* a ring of the last minute's seconds */

typedef struct rates {
    int64_t ticks; /* seconds since the start */
    int64_t stamps_at[RATE_SLOTS], jobs_at[RATE_SLOTS];
} rates;

/* Once a second: stamps measured and jobs ended since the start. */
void rates_tick(rates *r, int64_t stamps, int64_t jobs);
/* Over the last minute, or since the start where that is shorter. */
sheard_msg_rates rates_get(const rates *r);

#endif
