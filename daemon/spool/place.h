/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/place.h: the place of a file in done/ or failed/, and its fingerprint. */
#pragma once

#include "spool/folders.h"
#include "spool/spool.h"

/* Make a fingerprint of the file's size and modification time, which survive renames, and copies
 * that preserve times. */
void place_fingerprint(const struct stat *st, char out[SPOOL_FINGERPRINT_SIZE]);
/* Set *place to this file, or to "not known" if there is no such file. */
void place_set(const folders *f, spool_place *place, enum folder folder, const char *name);
/* Parse a place "failed/NAME": set *folder and return NAME, or NULL if it is not a place. */
const char *place_parse(const spool_place *place, enum folder *folder);
