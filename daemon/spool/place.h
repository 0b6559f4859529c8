/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/place.h: where an ended file lies. */
#ifndef SHEARD_SPOOL_PLACE_H
#define SHEARD_SPOOL_PLACE_H

#include "spool/folders.h"
#include "spool/spool.h"

/* The file's size and time of change: they go with it through renames and copies that keep times.
 */
void place_fingerprint(const struct stat *st, char out[SPOOL_FINGERPRINT_SIZE]);
/* This file is there now. */
void place_set(const folders *f, spool_place *place, enum folder folder, const char *name);
/* "failed/NAME" -> folder and NAME; NULL where the place is not one of ours. */
const char *place_parse(const spool_place *place, enum folder *folder);

#endif
