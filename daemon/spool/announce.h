/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/announce.h: report the files in active/ to the owner, by the callback `found`. */
#pragma once

#include "spool/spool.h"

/* Report some files. Return true if there are more. */
bool announce_files(spool *s);
