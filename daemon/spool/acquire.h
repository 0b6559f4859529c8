/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/acquire.h: when a dropped file is complete, and its move from incoming/ to active/. */
#pragma once

#include "spool/spool.h"

/* Make files ready that have not changed for long enough. Return true if there is more to do at
 * once. */
bool acquire_settled(spool *s);
/* Return when acquire_settled is due next, on the monotonic clock; INT64_MAX: never. */
int64_t acquire_next_ms(const spool *s);
/* Move ready files to active/, as many as the owner's capacity allows. Return true if there are
 * more. */
bool acquire_ready(spool *s);
