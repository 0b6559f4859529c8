/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/examine.h: what a file of incoming/ is. */
#ifndef SHEARD_SPOOL_EXAMINE_H
#define SHEARD_SPOOL_EXAMINE_H

#include "spool/candidates.h"
#include "spool/spool.h"
#include "spool/watch.h"

/* Look at it again, after `event`: it is ignored, or settles; where it is gone it is removed. */
void examine_file(spool *s, candidate *file, enum watch_event event);
/* It has this fingerprint from now on, and this state. */
void examine_settle(spool *s, candidate *file, const struct stat *st, enum candidate_state state);
/* True where it is a regular file still; else it is examined. */
bool examine_is_regular(spool *s, candidate *file, struct stat *st);

#endif
