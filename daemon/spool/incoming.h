/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/incoming.h: find the files of incoming/, by events and by scans. */
#pragma once

#include "spool/spool.h"
#include "spool/watch.h"

/* Process an event of the watch: the function for watch_read, with the spool as its context. */
void incoming_event(void *context, enum watch_event event, const char *name);
/* Check the folders and begin a scan. Return false if the spool is missing now. */
bool incoming_begin_scan(spool *s);
/* Continue the scan that is under way, if any. Return true if there is more. */
bool incoming_scan(spool *s);
