/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/undo_log.h: a record of a move between active/ and done/ or failed/ that is not complete.
 *
 * Two names have to appear, the report's and the file's, and no rename does both. So there is a
 * symbolic link active/.ACTIVE_NAME.end -> done/NAME in the meantime. If the link is found at the
 * start and the file is in active/, the report is removed; if the file has moved, only the link is.
 * The link needs no fsync: if a power failure loses it but not the report, there is a report too
 * many, but no file is lost or overwritten. */
#pragma once

#include "spool/folders.h"
#include "spool/names.h"

/* Undo the incomplete moves that a crash left in active/. */
int undo_log_recover(const folders *f, shear_error *err);
/* Record a move between active/ and FOLDER/NAME. Return 0 or errno. */
int undo_log_write(const folders *f, const char *active_name, enum folder folder, const char *name);
void undo_log_remove(const folders *f, const char *active_name);

/* Make the report's name until it is complete: active/.ACTIVE_NAME.tmp. */
void undo_log_temporary(char out[NAME_SIZE], const char *active_name);
