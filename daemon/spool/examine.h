/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/examine.h: which files of incoming/ are taken, ignored, or have to settle first. */
#pragma once

#include "spool/candidates.h"
#include "spool/spool.h"
#include "spool/watch.h"

/* Examine a file after `event`: set its state, or remove it if it no longer exists. */
void examine_file(spool *s, candidate *file, enum watch_event event);
/* Set the file's fingerprint, from *st, and state; its time starts now. */
void examine_settle(spool *s, candidate *file, const struct stat *st, enum candidate_state state);
