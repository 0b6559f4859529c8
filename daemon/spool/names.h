/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/names.h: names of files: which are accepted, and what they become in active/, done/ and
 * failed/. */
#pragma once

#include "spool/spool.h"

#include <limits.h>

enum name_status {
    NAME_GOOD,
    NAME_QUIET, /* passed over silently: a dotfile, *.tmp, *.part */
    NAME_SUFFIX,
    NAME_CONTROL,
    NAME_NOT_UTF8,
    NAME_LONG,
    NAME_N_STATUSES
};

enum {
    NAME_SIZE = NAME_MAX + 1,
    NAME_REPORT_SIZE = NAME_SIZE + sizeof ".json" - 1,
    /* Longest NAME with which .KEY-NAME.end is still a file name. */
    NAME_GOOD_MAX = NAME_MAX - (SPOOL_KEY_SIZE - 1) - 6
};

enum name_status name_validate(const char *name);
/* Copy the name for messages: what is not printable ASCII becomes '?'. */
void name_printable(char out[NAME_SIZE], const char *name);

/* Make KEY-NAME with a new key: time, `counter` and random bits. Return 0 or errno. */
int name_make_active(char out[NAME_SIZE], const char *name, uint64_t counter);
/* Return NAME within an active name, or NULL if that is not an active name. */
const char *name_of_active(const char *active_name);
/* Fail with SHEAR_E_INTERNAL: the caller's text is not an active name. */
int name_fail_active(const char *active_name, shear_error *err);
void name_key(char key[SPOOL_KEY_SIZE], const char *active_name);

/* Insert ".n" before the extension of NAME, which must be good; n = 0 leaves NAME unchanged. */
void name_number(char out[NAME_SIZE], const char *name, int64_t n);
/* Make "NAME.json". */
void name_report(char out[NAME_REPORT_SIZE], const char *name);
