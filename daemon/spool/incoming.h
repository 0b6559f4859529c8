/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/incoming.h: the files of incoming/ become known: by events and by scans. */
#ifndef SHEARD_SPOOL_INCOMING_H
#define SHEARD_SPOOL_INCOMING_H

#include "spool/spool.h"
#include "spool/watch.h"

/* The watch's. */
void incoming_event(spool *s, enum watch_event event, const char *name);
/* False where the spool is not there now. */
bool incoming_begin_scan(spool *s);
/* Go on with the scan that is under way. True: there is more. */
bool incoming_scan(spool *s);

#endif
