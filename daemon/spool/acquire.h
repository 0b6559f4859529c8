/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/acquire.h: from incoming/ to active/. */
#ifndef SHEARD_SPOOL_ACQUIRE_H
#define SHEARD_SPOOL_ACQUIRE_H

#include "spool/spool.h"

/* Files that have stood still for long enough are ready. True: there is more to do at once. */
bool acquire_settled(spool *s);
/* When acquire_settled has something to do. */
int64_t acquire_next_ms(const spool *s);
/* Move those that are ready, as many as the owner allows. True: as above. */
bool acquire_ready(spool *s);

#endif
