/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/announce.h: the owner is told of the files that are in active/. */
#ifndef SHEARD_SPOOL_ANNOUNCE_H
#define SHEARD_SPOOL_ANNOUNCE_H

#include "spool/spool.h"

/* Tell of some. True: there are more. */
bool announce_files(spool *s);

#endif
